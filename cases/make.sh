#!/bin/sh
# Remakes the mesh of a case, FOLDER/NAME.inp, and by CalculiX the exported matrices beside it: sh cases/make.sh cases/disc-pad
# A finer one, each brick divided into 3 x 3 x 3, with its case file in a folder of its own: sh cases/make.sh cases/disc-pad 3 OUT
# Needs python3 and ccx (Debian: apt-get install calculix-ccx).
set -eu
here=$(cd "$1" && pwd)
name=$(basename "$here")
out=$here
if [ $# -eq 3 ]; then
    mkdir -p "$3"
    out=$(cd "$3" && pwd)
    cp "$here/$name.toml" "$out"
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cd "$work"
python3 "$here/mesh.py" ${2:-} > "$name.inp"
ccx -i "$name" > log || { cat log >&2; exit 1; }
for kind in sti mas dof; do
    test -s "$name.$kind" || { cat log >&2; exit 1; }
    gzip -9 -n "$name.$kind"
done
mv "$name.inp" "$name.sti.gz" "$name.mas.gz" "$name.dof.gz" "$out"
