# Sourced by what compares a commit with the present tree. A program of a commit is built once.

goldens=${TRACKLOOM_GOLDENS:-${XDG_CACHE_HOME:-$HOME/.cache}/trackloom/goldens}

# As tests/run builds, so that nothing is compiled twice.
everything=(--locked --workspace --features s3,parquet)

program_of() { # NAME COMMIT BUILD: the path of the program that BUILD TARGET_DIRECTORY makes of a checkout and names
    local commit kept tree built
    commit=$(git rev-parse --verify "$2^{commit}") || return
    kept=$goldens/$1-$commit
    if [ ! -x "$kept" ]; then
        mkdir -p "$goldens"
        tree=$(mktemp -d)
        git worktree add --quiet --detach "$tree" "$commit" || return
        # A target directory of its own: in one that two checkouts share, cargo takes files of one for the other's.
        if built=$(cd "$tree" && TRACKLOOM_SKIP_DASHBOARD=1 "$3" "$goldens/target"); then
            cp "$built" "$kept"
        fi
        git worktree remove --force "$tree"
    fi
    [ -x "$kept" ] && echo "$kept"
}
