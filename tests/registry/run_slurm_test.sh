#!/usr/bin/env bash
# Runs share/byre/registry/worker.sbatch on a cluster of this computer alone: two workers map a recording and propose it.
# Usage: run_slurm_test.sh BYRE RENDER_ROOM       Exit code 77: skipped, because Slurm or PostgreSQL is missing
set -euo pipefail

byre=${1:?usage: run_slurm_test.sh BYRE RENDER_ROOM}
render_room=${2:?usage: run_slurm_test.sh BYRE RENDER_ROOM}
source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
PATH=$(dirname "$byre"):$PATH:/usr/sbin
for program in munged slurmctld slurmd sbatch; do
  command -v $program >/dev/null || { echo "Skipped: no $program on this system (apt install slurm-wlm munge)"; exit 77; }
done
work=$(mktemp -d)
chmod 711 "$work"

fail() {
  echo "run_slurm_test.sh: $1" >&2
  tail -n 20 "$work"/*.log >&2
  exit 1
}

# Ends a daemon by the file of its process id.
end() {
  [[ -f $1 ]] || return 0
  local process
  process=$(<"$1")
  kill "$process" 2>/dev/null || return 0
  for ((i = 0; i < 100; ++i)); do
    [[ $(ps --no-headers --format state --pid "$process") == [^Z]* ]] || return 0 # zombies count as ended
    sleep 0.1
  done
  kill -9 "$process"
}

clean_up() {
  for daemon in slurmd slurmctld munged; do end "$work/$daemon.pid"; done
  [[ ! -d $work/registry/data ]] || "$source_dir/scripts/registry.sh" "$work/registry" stop || true
  rm -rf "$work"
}
trap clean_up EXIT

settings=$("$source_dir/scripts/registry.sh" "$work/registry") || { code=$?; echo "Skipped or failed: no server"; exit $code; }
eval "$settings"
byre registry init barn >/dev/null
"$render_room" "$work/room" --frames 20 --rate 10 --laps 0.1 2>/dev/null
byre registry request barn --map "$work/room" >/dev/null
byre map "$work/room" -o "$work/expected.byre" --quiet >/dev/null

mkdir -m 711 "$work/munge"
mkdir "$work/state" "$work/spool"
head -c 128 /dev/urandom >"$work/key"
chmod 600 "$work/key"
munged --key-file="$work/key" --socket="$work/munge/socket" --pid-file="$work/munged.pid" \
  --log-file="$work/munged.log" --seed-file="$work/seed" --num-threads=2 || fail "munged does not start"
port=$((20000 + $$ % 20000 * 2))
cat >"$work/slurm.conf" <<CONF
ClusterName=byre
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthInfo=socket=$work/munge/socket
SlurmctldPort=$port
SlurmdPort=$((port + 1))
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
SelectType=select/cons_tres
NodeName=$(hostname -s) NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=byre Nodes=ALL Default=YES State=UP
CONF
echo "CgroupPlugin=cgroup/v1" >"$work/cgroup.conf" # loaded, but not used
export SLURM_CONF=$work/slurm.conf
slurmctld -c || fail "slurmctld does not start"
slurmd || fail "slurmd does not start"
timeout 120 sbatch --wait --array=1-2 --output="$work/worker.%a.log" "$source_dir/share/byre/registry/worker.sbatch" --once \
  >"$work/sbatch.log" 2>&1 || fail "the workers fail"

id=$(byre history "$work/expected.byre" | head -c 16)
[[ $(byre registry list barn) == "proposed     $id"* ]] || fail "version $id is not proposed: $(byre registry list barn)"
grep -q "^job 1 done: room mapped" "$work"/worker.?.log || fail "no worker did the job"
