# What the scripts share: where things are, how many processors, and what they say. Sourced, never run.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
preset=${GONIO_PRESET:-release}
build=$root/build/$preset
jobs=${GONIO_JOBS:-$(nproc)}
data=${GONIO_DATA:-$root/../shared/data}

# Compiler cache across checkouts of the project in different folders.
export CCACHE_BASEDIR=${CCACHE_BASEDIR:-$root} CCACHE_NOHASHDIR=1

say() { printf '%s\n' "$*" >&2; }

fail() {
  say "$(basename "$0"): $1"
  exit "${2:-1}"
}

# The programs as built come before all others, among them ImageMagick's compare.
use_built_programs() { export PATH="$build/bin:$PATH"; }
