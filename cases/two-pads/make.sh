#!/bin/sh
# Remakes two-pads.inp and, by CalculiX, the exported matrices beside this script.
# Needs python3 and ccx (Debian: apt-get install calculix-ccx).
set -eu
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cd "$work"
python3 "$here/mesh.py" > two-pads.inp
ccx -i two-pads > log || { cat log >&2; exit 1; }
for kind in sti mas dof; do
    test -s "two-pads.$kind" || { cat log >&2; exit 1; }
    gzip -9 -n "two-pads.$kind"
done
mv two-pads.inp two-pads.sti.gz two-pads.mas.gz two-pads.dof.gz "$here"
