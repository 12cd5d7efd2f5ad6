#!/usr/bin/env bash
# A sequence as a Slurm array: every task computes its part, and whatever runs again keeps what is done.
#   sbatch --array=1-8 examples/farm/slurm.sh shot.%04d.exr -o ao/shot.%04d.exr --frames 1001-1100 --camera shot.json --radius 0.5
# To run some parts of it again: CHUNKS=8 sbatch --array=3,5 ...
# SPDX-License-Identifier: BSD-3-Clause
#SBATCH --job-name=alcove
#SBATCH --array=1-4
#SBATCH --requeue
set -euo pipefail
# In the place of this script, so that Slurm's signals reach the program and its exit code reaches Slurm.
exec "${ALCOVE:-alcove}" run "$@" --chunk "$SLURM_ARRAY_TASK_ID/${CHUNKS:-$SLURM_ARRAY_TASK_MAX}" --resume --threads "${SLURM_CPUS_PER_TASK:-$SLURM_CPUS_ON_NODE}"
