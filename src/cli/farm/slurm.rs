//! Slurm: a job array, and a job that verifies the frames after the whole array has ended.

use anyhow::ensure;

use super::Farm;
use super::shell::ShellWord;

/// Returns a script that submits both jobs.
pub(super) fn script(farm: &Farm) -> anyhow::Result<String> {
    let shard = ShellWord::quote("--shard=")?
        + ShellWord::variable("SLURM_ARRAY_TASK_ID")
        + ShellWord::quote(&format!("/{}", farm.shards))?;
    let render = ShellWord::command(&farm.render(ShellWord::quote, shard)?);
    let verify = ShellWord::command(&farm.verify(ShellWord::quote)?);
    let (name, out) = (&farm.name, ShellWord::quote(&farm.out)?);
    let (render_log, verify_log) = (log(farm, "%a.log")?, log(farm, "verify.log")?);
    let (shards, last) = (farm.shards, farm.shards - 1);
    Ok(format!(
        r#"#!/bin/sh
# Renders in {shards} shards, and verifies that all frames are there: run it with sh where sbatch is.
# Shards share a folder, which all nodes must see under this name. Add the options that your cluster needs (--partition,
# --time, --cpus-per-task) to both calls of sbatch.
set -eu
mkdir -p -- {out}

# A shard whose node fails, or whose time is nearly over, is queued again and renders the frames that are left: valid
# frames are kept. A cancelled shard is not queued again.
array=$(sbatch --parsable --job-name={name} --array=0-{last} --requeue --open-mode=append \
    --signal=B:USR1@60 {render_log} <<'RENDER'
#!/bin/sh
{render} &
shard=$!
stop() {{ kill -TERM "$shard"; wait "$shard" || true; }}
trap 'stop; scontrol requeue "${{SLURM_ARRAY_JOB_ID}}_${{SLURM_ARRAY_TASK_ID}}"; exit 143' USR1
trap 'stop; exit 143' TERM
wait "$shard"
RENDER
)
array=${{array%%;*}}

# `afterany`, not `afterok`: a failed shard may have left all its frames. The exit code of this job is the verdict.
verify=$(sbatch --parsable --job-name={name}-verify --dependency="afterany:$array" \
    {verify_log} <<'VERIFY'
#!/bin/sh
exec {verify}
VERIFY
)
echo "shards are job $array; job ${{verify%%;*}} verifies them"
"#
    ))
}

/// Returns the option for a log in the folder of the frames. Slurm replaces `%a` in its path and reads `%%` as `%`. A backslash anywhere
/// in the path would disable these replacements.
fn log(farm: &Farm, ending: &str) -> anyhow::Result<ShellWord> {
    let out = &farm.out;
    ensure!(!out.contains('\\'), "`{out}` has a backslash, an escape in Slurm's paths: name another --out");
    ShellWord::quote(&format!("--output={}/{}.{ending}", out.replace('%', "%%"), farm.name))
}
