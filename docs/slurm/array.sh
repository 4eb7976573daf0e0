#!/bin/bash
# Shards of a run as an array of jobs: sbatch docs/slurm/array.sh experiment.yaml
# USR1 comes two minutes before the limit; a job that was stopped goes back into the queue and goes on from its checkpoint.
#SBATCH --array=1-100 --cpus-per-task=16 --time=24:00:00 --signal=B:USR1@120 --requeue
shard=$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT
rabiline run "$1" --shard "$shard" --threads "$SLURM_CPUS_PER_TASK" -o "part-$SLURM_ARRAY_TASK_ID.h5" &
trap 'kill -USR1 $!' USR1
wait $!; code=$?
if [ $code -gt 128 ]; then wait $!; code=$?; fi  # the shell woke up for the signal
if [ $code = 4 ]; then scontrol requeue "${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID"; fi
exit $code
