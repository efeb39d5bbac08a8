#!/usr/bin/env bash
# Makes a Debian package and looks into it: what it depends on and recommends, what lintian says, and whether it works where it is
# unpacked. Arguments: build folder, source folder, and cpack. Skipped (77) where Debian's tools are not.
set -euo pipefail
build=$1 source=$2 cpack=$3

for tool in "$cpack" dpkg-deb dpkg-shlibdeps; do
  command -v "$tool" >/dev/null || {
    echo "skipped: there is no $tool"
    exit 77
  }
done
work=$(mktemp -d "${TMPDIR:-/tmp}/perilat package.XXXXXX")
trap 'rm -rf "$work"' EXIT
fail() {
  echo "FAILED: $*" >&2
  exit 1
}
trap 'echo "FAILED: line $LINENO" >&2' ERR
cd "$work"

"$cpack" -G DEB --config "$build/CPackConfig.cmake" -B "$work" >cpack.log 2>&1 || { cat cpack.log; fail "cpack"; }
package=$(find . -maxdepth 1 -name 'perilat_*.deb')
dpkg-deb -f "$package" >control
grep -q '^Depends: .*libhdf5.*liblapack3' control || fail "$(cat control)"
grep -q '^Depends: .*libcholmod' control || fail "$(cat control)"
grep -q '^Recommends: gcc | c-compiler' control || fail "gcc is not recommended"
grep -q '^Section: science' control

mkdir tree
dpkg-deb -x "$package" tree
grep -q 'No licence has been chosen yet' tree/usr/share/doc/perilat/copyright
gzip -t tree/usr/share/doc/perilat/changelog.Debian.gz tree/usr/share/man/man1/perilat.1.gz
if grep -r -l -a -F -e "$source" -e "$build" -e "$work" tree; then
  fail "these files name the folders of the build"
fi
tree/usr/bin/perilat check cohesive | grep -q 'no errors' || fail "the program that is packed"

# The licence is all that lintian may miss.
if command -v lintian >/dev/null; then
  lintian --allow-root "$package" >lintian.log 2>/dev/null || true
  if grep -v 'copyright-without-copyright-notice' lintian.log; then
    fail "lintian"
  fi
else
  echo "lintian is not here: not asked"
fi
echo "packed and unpacked"
