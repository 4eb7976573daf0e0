#!/bin/bash
# One run on all processes of a job: sbatch docs/slurm/ranks.sh experiment.yaml OUT.h5
# It stops by itself before the limit, goes back into the queue and goes on from its checkpoint.
#SBATCH --ntasks=64 --cpus-per-task=16 --time=24:00:00 --requeue
mpirun --map-by "slot:PE=$SLURM_CPUS_PER_TASK" rabiline run "$1" --threads "$SLURM_CPUS_PER_TASK" -o "$2" --max-time "${MOST:-23.9 h}"
code=$?
if [ $code = 4 ]; then scontrol requeue "$SLURM_JOB_ID"; fi
exit $code
