//! Trees drawn as text.

/// A node of a tree, with its facts and children.
#[derive(Clone, Debug, Default)]
pub(super) struct TreeNode {
    pub(super) title: String,
    /// The names and the values of facts.
    pub(super) facts: Vec<(&'static str, String)>,
    pub(super) children: Vec<TreeNode>,
}

impl TreeNode {
    /// Creates a node with only a title.
    pub(super) fn leaf(title: String) -> Self {
        Self { title, ..Self::default() }
    }

    /// Draws the tree, line by line.
    pub(super) fn draw(&self) -> String {
        let mut drawn = String::new();
        self.draw_into(&mut drawn, "");
        drawn
    }

    /// Appends the drawn tree. Every line starts with `prefix`, except the first, which continues the current line.
    fn draw_into(&self, drawn: &mut String, prefix: &str) {
        drawn.push_str(self.title.trim_end());
        drawn.push('\n');
        let rail = if self.children.is_empty() { "   " } else { "│  " };
        for (label, value) in &self.facts {
            drawn.push_str(format!("{prefix}{rail}{label:<11}{value}").trim_end());
            drawn.push('\n');
        }
        for (index, child) in self.children.iter().enumerate() {
            let (branch, rail) =
                if index + 1 < self.children.len() { ("├─ ", "│  ") } else { ("└─ ", "   ") };
            drawn.push_str(prefix);
            drawn.push_str(branch);
            child.draw_into(drawn, &format!("{prefix}{rail}"));
        }
    }
}
