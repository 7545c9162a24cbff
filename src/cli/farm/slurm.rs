//! Slurm: a job array, and a job that looks at what is there when all of it has ended.

use super::{Farm, line, quoted};

/// Returns a script that submits both.
pub(super) fn script(farm: &Farm) -> String {
    // The shell of the job puts the number in, outside of quotes.
    const INDEX: &str = "SLURM_INDEX";
    let render = line(&farm.render(INDEX)).replace(INDEX, "\"$SLURM_ARRAY_TASK_ID\"");
    let (verify, name, out) = (line(&farm.verify()), &farm.name, quoted(&farm.out));
    let last = farm.shards - 1;
    format!(
        r#"#!/bin/sh
# Renders {scene} in {shards} shards, and looks whether all frames are there: run it with sh where sbatch is.
# Shards share a folder, which all nodes must see under this name. Add what your cluster wants (--partition,
# --time, --cpus-per-task) to both calls of sbatch.
set -eu
mkdir -p -- {out}

# A shard whose node fails, or whose time is nearly over, is queued again, and goes on with the frames that are left: what is
# whole and the same is kept. One that is cancelled stays so.
array=$(sbatch --parsable --job-name={name} --array=0-{last} --requeue --open-mode=append \
    --signal=B:USR1@60 --output={out}/{name}.%a.log <<'RENDER'
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

# `afterany`, not `afterok`: only the frames tell whether the frames are there. This job's exit code is the verdict.
verify=$(sbatch --parsable --job-name={name}-verify --dependency="afterany:$array" \
    --output={out}/{name}.verify.log <<'VERIFY'
#!/bin/sh
exec {verify}
VERIFY
)
echo "shards are job $array; job ${{verify%%;*}} verifies them"
"#,
        scene = farm.scene.replace(|character: char| character.is_control(), "?"),
        shards = farm.shards,
    )
}
