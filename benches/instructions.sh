#!/usr/bin/env bash
# Instructions of the kernels, scalar and eight lanes wide, counted by callgrind: what other loads on a machine do not change.
#
#   benches/instructions.sh [ROW...]      rows of the bench simd_vs_scalar; needs valgrind
#
# Each kernel runs one round and three; the difference is two rounds without whatever it takes to begin.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
command -v valgrind >/dev/null || { echo "no valgrind" >&2; exit 2; }

rows=("$@")
((${#rows[@]})) || rows=(bare flight/homogeneous flight/grid64 transmittance/grid64 flight/grid256 transmittance/grid256)
bench=$(cargo bench --quiet -p woodcock-benches --bench simd_vs_scalar --no-run --message-format=json |
    sed -n 's/.*"executable":"\([^"]*simd_vs_scalar[^"]*\)".*/\1/p')
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# instructions ROW WIDTH ROUNDS: their number; paths and collisions of a round go to a file.
instructions() {
    valgrind --tool=callgrind --callgrind-out-file="$scratch/out" "$bench" --count "$1" "$2" "$3" \
        >"$scratch/work" 2>"$scratch/log"
    sed -n 's/^summary: //p; s/^totals: //p' "$scratch/out" | head -1
}

printf '%-24s %12s %12s %12s %12s\n' row 'x1 /path' 'x8 /path' 'x1 /coll' 'x8 /coll'
for row in "${rows[@]}"; do
    x1=$(($(instructions "$row" scalar 3) - $(instructions "$row" scalar 1)))
    x8=$(($(instructions "$row" packet 3) - $(instructions "$row" packet 1)))
    read -r paths collisions <"$scratch/work"
    awk -v row="$row" -v x1="$x1" -v x8="$x8" -v p="$paths" -v c="$collisions" 'BEGIN {
        printf "%-24s %12.1f %12.1f", row, x1 / 2 / p, x8 / 2 / p
        if (c > 0) printf " %12.1f %12.1f", x1 / 2 / c, x8 / 2 / c
        print ""
    }'
done
