#!/usr/bin/env bash
# Checks the API documents with other people's validators, generates a client with each of five generators as it comes,
# compiles them, and plays a session with each against a running service, and one with the package of examples/python. Then a
# short run of schemathesis.
# Usage: tests/client/run.sh [path of the trackloom program]; without one it is built.
set -euo pipefail
# shellcheck source=tests/client/support.sh
. "$(dirname "$0")/support.sh"
program=${1:-}
document=$root/openapi/openapi.json
document_3_0=$root/openapi/openapi-3.0.json

if [ -z "$program" ]; then
    (cd "$root" && cargo build --quiet)
    program=${CARGO_TARGET_DIR:-$root/target}/debug/trackloom
fi

quietly() { # COMMAND...: its output only where it fails
    "$@" >"$work/log" 2>&1 || { cat "$work/log"; echo "failed: $*" >&2; return 1; }
}

check_documents() {
    quietly openapi-spec-validator "$document" "$document_3_0"
    quietly redocly lint --config "$client/redocly.yaml" "$document" "$document_3_0"
    echo "documents: valid"
}

session() { # COMMAND...: with the address of a service of its own, and the folder of the data
    start_server "$program"
    "$@" "$address" "$client/data" || { cat "$work/server.log"; return 1; }
    stop_server
}

example() { # COMMAND...: prints how many detections it has seen
    start_server "$program"
    local printed
    printed=$(cd "$client/data" && TRACKLOOM_URL=$address "$@" 2>"$work/log") || { cat "$work/log" "$work/server.log"; return 1; }
    [ "$printed" = "24 detections" ] || { echo "the example prints '$printed'" >&2; return 1; }
    stop_server
}

check_examples() { # The page shows the very text that is run here.
    local shown='
import sys
page = open(sys.argv[1]).read()
missing = [name for name in sys.argv[2:] if open(name).read() not in page]
sys.exit(f"docs/api-clients.md does not show {missing}" if missing else 0)'
    python -c "$shown" "$root/docs/api-clients.md" "$client"/examples/* "$client/progenitor/src/example.rs"
}

openapi_python_client() {
    openapi-python-client generate --path "$document" --meta none --output-path "$work/trackloom_client" >"$work/log" 2>&1 || { cat "$work/log"; return 1; }
    # A warning means that an operation or a schema was left out.
    if grep -i -E "warning|skipping|missing|unable|error|omitted" "$work/log"; then
        cat "$work/log"
        echo "the generator left something out" >&2
        return 1
    fi
    local expected generated
    expected=$(grep -c '"operationId"' "$document")
    generated=$(find "$work/trackloom_client/api" -name '*.py' ! -name '__init__.py' | wc -l)
    if [ "$expected" -ne "$generated" ]; then
        echo "the document has $expected operations, the client $generated" >&2
        return 1
    fi
    export PYTHONPATH=$work
    session python "$client/sessions/openapi_python_client.py"
    example python "$client/examples/openapi_python_client.py"
}

openapi_generator_python() {
    quietly openapi-generator-cli generate -g python -i "$document" -o "$work/openapi_generator"
    export PYTHONPATH=$work/openapi_generator
    session python "$client/sessions/openapi_generator.py"
    example python "$client/examples/openapi_generator.py"
}

typescript() { # NAME: session and example, type-checked, bundled and run beside what was generated in $work/NAME/generated
    cp "$client/sessions/$1.ts" "$work/$1/session.ts"
    cp "$client/examples/$1.ts" "$work/$1/example.ts"
    cp "$client/tsconfig.json" "$work/$1"
    ln -sfn "$cache/node/node_modules" "$work/node_modules"
    quietly tsc --project "$work/$1"
    quietly esbuild "$work/$1/session.ts" "$work/$1/example.ts" --bundle --platform=node --format=esm --outdir="$work/$1" --out-extension:.js=.mjs
    session node "$work/$1/session.mjs"
    example node --no-warnings "$work/$1/example.mjs"
}

openapi_generator_typescript() {
    quietly openapi-generator-cli generate -g typescript-fetch -i "$document" -o "$work/typescript_fetch/generated"
    typescript typescript_fetch
}

openapi_typescript() {
    quietly openapi-typescript "$document" --output "$work/openapi_fetch/generated/api.d.ts"
    typescript openapi_fetch
}

hey_api() {
    quietly openapi-ts --input "$document" --output "$work/hey_api/generated"
    typescript hey_api
}

python_package() {
    local package=$root/examples/python
    quietly mypy --strict --cache-dir "$work/mypy" "$package/trackloom"
    quietly ruff check --no-cache "$package/trackloom" "$client/package"
    # As the page installs it, from a copy: a build leaves files beside the source.
    cp -r "$package" "$work/package"
    quietly pip install --disable-pip-version-check --no-deps --target "$work/site" "$work/package[pandas]"
    export PYTHONPATH=$work/site PYTHONDONTWRITEBYTECODE=1
    start_server "$program"
    python "$client/package/session.py" "$address" "$client/data" "$work" || { cat "$work/server.log"; return 1; }
    # The page shows what is run.
    python - "$root/docs/python.md" >"$work/example.py" <<'END'
import re, sys
print(re.search(r"```python\n(.*?)```", open(sys.argv[1]).read(), re.S).group(1))
END
    local printed
    printed=$(cd "$client/data" && TRACKLOOM_URL=$address python "$work/example.py") || { cat "$work/server.log"; return 1; }
    [ "$printed" = $'24 points of 2 tracks\nrecall 0.83, limits met: True' ] || { echo "the example prints '$printed'" >&2; return 1; }
    stop_server
}

progenitor() {
    (cd "$client/progenitor" && CARGO_TARGET_DIR=$cache/progenitor quietly cargo build --locked)
    session "$cache/progenitor/debug/trackloom-progenitor-session"
}

install_python
install_node
check_documents
check_examples
for generator in openapi_python_client openapi_generator_python openapi_generator_typescript openapi_typescript hey_api progenitor python_package; do
    began=$SECONDS
    "$generator"
    echo "  $((SECONDS - began)) s"
done
"$client/schemathesis.sh" "$program" 200
