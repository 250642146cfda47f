#!/usr/bin/env bash
# Is a commit slower than another where scenes hold media alone? Builds both, runs them A B A B, and prints the median of
# the ratios within rounds of samples per CPU second, B over A: 1 is as fast, below 0.97 is a regression.
#
#   benches/compare.sh A [B [ROUNDS]]      commits; B is HEAD, ROUNDS are 15
#
# Builds and checkouts stay under the target directory, so that a second comparison is quick. One thread.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

[[ $# -ge 1 && $# -le 3 ]] || { sed -n '2,/^set/{/^#/p}' "${BASH_SOURCE[0]}"; exit 2; }
a=$(git rev-parse --verify --short=12 "$1^{commit}")
b=$(git rev-parse --verify --short=12 "${2:-HEAD}^{commit}")
rounds=${3:-15}
target=${CARGO_TARGET_DIR:-$PWD/target}/compare
mkdir -p "$target"

for commit in "$a" "$b"; do
    binary=$target/woodcock-$commit
    [[ -x $binary ]] && continue
    tree=$(mktemp -d "$target/tree.XXXXXX")
    git worktree add --quiet --detach "$tree" "$commit"
    # The same directory for both: dependencies are built once, and paths in the binaries do not differ.
    (cd "$tree" && CARGO_TARGET_DIR=$target/build cargo build --release --quiet --package woodcock-host)
    cp "$target/build/release/woodcock" "$binary"
    git worktree remove --force "$tree"
done

# Samples per CPU second: `pace COMMIT SAMPLES [SCENE]`.
pace() {
    local stats=$target/stats.json
    "$target/woodcock-$1" "${@:3}" --quiet --threads 1 --resolution 240x136 --spp "$2" \
        --output "$target/picture.exr" --stats "$stats"
    awk -F'[:,]' '/"paths"/ { paths = $2 } /"cpu_seconds"/ { seconds = $2 } END { print paths / seconds }' "$stats"
}

median() { sort -g | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'; }

printf '%-12s %14s %14s %8s\n' scene "$a" "$b" ratio
compare() { # NAME SAMPLES [SCENE]
    local name=$1 as=() bs=() ratios=() before after
    shift
    for ((round = 0; round < rounds; round++)); do
        before=$(pace "$a" "$@")
        after=$(pace "$b" "$@")
        as+=("$before")
        bs+=("$after")
        ratios+=("$(awk -v a="$before" -v b="$after" 'BEGIN { print b / a }')")
    done
    awk -v name="$name" -v a="$(printf '%s\n' "${as[@]}" | median)" -v b="$(printf '%s\n' "${bs[@]}" | median)" \
        -v ratio="$(printf '%s\n' "${ratios[@]}" | median)" \
        'BEGIN { printf "%-12s %9.3f Ms/s %9.3f Ms/s %8.3f\n", name, a / 1e6, b / 1e6, ratio }'
}
compare cloud 16
compare fog 256 host/scenes/fog-sphere.pbrt
compare blobs 128 host/scenes/uniformgrid.pbrt
