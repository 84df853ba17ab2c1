#!/bin/sh
# Remakes disc-pad.inp and, by CalculiX, the exported matrices beside this script.
# Needs python3 and ccx (Debian: apt-get install calculix-ccx).
set -eu
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cd "$work"
python3 "$here/mesh.py" > disc-pad.inp
ccx -i disc-pad > log || { cat log >&2; exit 1; }
for kind in sti mas dof; do
    test -s "disc-pad.$kind" || { cat log >&2; exit 1; }
    gzip -9 -n "disc-pad.$kind"
done
mv disc-pad.inp disc-pad.sti.gz disc-pad.mas.gz disc-pad.dof.gz "$here"
