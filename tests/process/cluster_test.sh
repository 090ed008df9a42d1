#!/bin/bash
# Nodes by a real Slurm and by real sshds, where this machine can have them: tests/cluster, shortened.
exec "$PROJECT_ROOT/tests/cluster" --short
