# What a build for another machine needs; sourced by `.ci/run` and by `host/examples/web/build`, which say where `$target` is.
# shellcheck shell=bash

wasm=wasm32-unknown-unknown
bare=thumbv7em-none-eabihf

say() { printf '== %4ds  %s\n' "$SECONDS" "$*"; }
fail() { say "FAILED: $*"; exit 1; }

rustup_has() { command -v rustup >/dev/null && rustup target list --installed 2>/dev/null | grep -qx "$1"; }

debian_ready() { [[ -x /usr/bin/rustc && -x /usr/bin/cargo && -d $(/usr/bin/rustc --print sysroot)/lib/rustlib/src ]]; }

debian_llvm() { /usr/bin/rustc -vV | sed -n 's/^LLVM version: \([0-9]*\).*/\1/p'; }

# Makes `cross TARGET STD CARGO-ARGUMENTS...` possible for the target, or ends with what to install.
need_cross() {
    local packages=(rustc-web cargo-web rust-web-src)
    rustup_has "$1" && return
    if [[ $(id -u) == 0 ]] && command -v apt-get >/dev/null; then
        export DEBIAN_FRONTEND=noninteractive
        if ! debian_ready; then
            say "installing ${packages[*]}"
            apt-get update -qq
            apt-get install -yqq --no-install-recommends "${packages[@]}" >/dev/null
        fi
        if [[ ! -x /usr/bin/ld.lld-$(debian_llvm) ]]; then
            say "installing lld-$(debian_llvm)"
            apt-get update -qq
            apt-get install -yqq --no-install-recommends "lld-$(debian_llvm)" >/dev/null
        fi
    fi
    if ! debian_ready; then
        fail "no compiler for $1: run 'rustup target add $1', or on Debian 'apt-get install ${packages[*]}'"
    fi
    [[ -x /usr/bin/ld.lld-$(debian_llvm) ]] || fail "no linker for $1: 'apt-get install lld-$(debian_llvm)'"
}

# cross TARGET STD COMMAND CARGO-ARGUMENTS...: cargo for another machine; STD lists the library crates it needs.
# Two compilers must not share a target directory, hence $target/cross.
cross() {
    local triple=$1 std=$2 command=$3
    shift 3 # what follows may have a part for rustc, after which cargo reads nothing
    if rustup_has "$triple"; then
        CARGO_TARGET_DIR=$target/cross cargo "$command" --target "$triple" "$@"
        return
    fi
    local llvm
    llvm=$(debian_llvm)
    # RUSTC_BOOTSTRAP lets a released compiler build its own library; RUSTDOC keeps the two from mixing.
    env PATH="/usr/bin:$PATH" RUSTC=/usr/bin/rustc RUSTDOC=/usr/bin/rustdoc RUSTC_BOOTSTRAP=1 \
        CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER="wasm-ld-$llvm" \
        CARGO_TARGET_THUMBV7EM_NONE_EABIHF_LINKER="ld.lld-$llvm" \
        CARGO_TARGET_DIR="$target/cross" \
        /usr/bin/cargo "$command" --target "$triple" "-Zbuild-std=$std" "$@"
}

# need_tool TOOL PACKAGE: a program of a Debian package.
need_tool() {
    if ! command -v "$1" >/dev/null && [[ $(id -u) == 0 ]] && command -v apt-get >/dev/null; then
        say "installing $2"
        export DEBIAN_FRONTEND=noninteractive
        apt-get update -qq
        apt-get install -yqq --no-install-recommends "$2" >/dev/null
    fi
    command -v "$1" >/dev/null || fail "no $1: on Debian 'apt-get install $2'"
}

# shrink FROM TO: a WebAssembly module with fewer bytes. The passes of wasm-opt -Oz but for the propagation of constants, which writes
# out the vectors that hold the same number in every lane, at 18 bytes each: packets grow by a third.
shrink() {
    local passes=(
        duplicate-function-elimination remove-unused-module-elements dce remove-unused-names remove-unused-brs
        optimize-instructions pick-load-signs code-pushing simplify-locals vacuum reorder-locals coalesce-locals
        simplify-locals vacuum reorder-locals local-cse simplify-locals coalesce-locals reorder-locals remove-unused-brs
        code-folding merge-blocks remove-unused-brs remove-unused-names merge-blocks optimize-instructions rse vacuum
        reorder-functions
    )
    wasm-opt --all-features --optimize-level=2 --shrink-level=2 "${passes[@]/#/--}" "$1" -o "$2"
}
