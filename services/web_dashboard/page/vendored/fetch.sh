#!/bin/sh
# Fetches the page's libraries from npm: the versions that THIRD_PARTY.md lists.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
cd "$folder"
take() { # name, version, files of the package
    mkdir "$1" && npm pack --silent "$1@$2" > /dev/null && tar xzf "$1-$2.tgz" -C "$1"
    mkdir -p "$here/$1"
    package=$1
    shift 2
    for file in LICENSE "$@"; do cp "$package/package/$file" "$here/$package/"; done
}
take three 0.185.0 build/three.module.min.js build/three.core.min.js examples/jsm/controls/OrbitControls.js
take uplot 1.6.32 dist/uPlot.esm.js dist/uPlot.min.css
