-- Opens ball.ron, starts the language server as a user's settings do, and writes what the editor shows into the file "shown".
local shown = {}
local function show(what, text)
    table.insert(shown, what .. ": " .. text)
end
local function wait(what, is_done)
    if not vim.wait(60000, is_done, 20) then
        show("waited in vain for", what)
    end
end

vim.cmd("edit ball.ron")
local client = vim.lsp.start_client({ name = "rayreel", cmd = { vim.env.RAYREEL, "lsp" }, root_dir = vim.fn.getcwd() })
vim.lsp.buf_attach_client(0, client)

wait("diagnostics", function() return #vim.diagnostic.get(0) > 0 end)
for _, found in ipairs(vim.diagnostic.get(0)) do
    show("diagnostic", found.lnum .. ":" .. found.col .. " " .. found.message:gsub("\n", " / "))
end

local function cursor_at(text)
    vim.fn.cursor(1, 1)
    vim.fn.search(text, "cW")
end

cursor_at("k_d")
vim.lsp.buf.hover()
local function float()
    for _, window in ipairs(vim.api.nvim_list_wins()) do
        if vim.api.nvim_win_get_config(window).relative ~= "" then return window end
    end
end
wait("a hover", float)
show("hover", table.concat(vim.api.nvim_buf_get_lines(vim.api.nvim_win_get_buf(float()), 0, -1, false), " / "))
vim.api.nvim_win_close(float(), true)

cursor_at("shape: S")
vim.cmd("normal! 7l")
local answers = vim.lsp.buf_request_sync(0, "textDocument/completion", vim.lsp.util.make_position_params(), 60000)
for _, item in ipairs(vim.lsp.util.text_document_completion_list_to_complete_items(answers[client].result, "")) do
    show("completion", item.abbr .. " -> " .. item.word)
end

cursor_at('material: "cl')
vim.cmd("normal! 12l")
vim.lsp.buf.definition()
local before = vim.fn.line(".")
wait("a definition", function() return vim.fn.line(".") ~= before end)
show("definition", vim.fn.getline("."))

-- Mending the mistake removes its diagnostic.
vim.cmd('%s/"cly"/"clay"/')
wait("no diagnostics", function() return #vim.diagnostic.get(0) == 0 end)
show("diagnostics", tostring(#vim.diagnostic.get(0)))
vim.fn.writefile(shown, "shown")
vim.cmd("quitall!")
