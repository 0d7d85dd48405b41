#!/bin/sh
# Installs the .deb on a fresh Debian, tries it there, removes it, and looks at what is left.
#
#     try-deb.sh DEB REFERENCE [SUITE]
#
# REFERENCE is a `faceedit` of this machine, whose export must be the same. Needs root, debootstrap
# and a Debian mirror; makes and removes a root folder in build/.
set -eu

deb=$1 reference=$2 suite=${3:-bookworm}
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p build
root=$(mktemp -d "$PWD/build/root.XXXXXX")
trap 'umount "$root/proc" 2>/dev/null || true; rm -rf --one-file-system "$root"' EXIT

# The kernels are those of the reference: others may differ in the last digit.
inside() { chroot "$root" env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 \
	DEBIAN_FRONTEND=noninteractive ${OPENBLAS_CORETYPE:+OPENBLAS_CORETYPE="$OPENBLAS_CORETYPE"} "$@"; }
install() { inside apt-get -qq install -y --no-install-recommends "$@" >/dev/null 2>"$root/apt.log" ||
	{ cat "$root/apt.log"; exit 1; }; }
fail() { echo "try-deb: $*" >&2; exit 1; }

debootstrap --variant=minbase "$suite" "$root" >"$root.log" || { tail "$root.log"; exit 1; }
rm -f "$root.log"
chmod 755 "$root"
mount -t proc proc "$root/proc"
inside sh -c 'cd / && find bin etc lib* opt sbin usr 2>/dev/null | sort' >"$root/before"
cp "$deb" "$root/faceedit.deb"
cp "$here/../smoke_test.py" "$root/smoke_test.py"

echo "Installing on $suite"
inside apt-get -qq update
install /faceedit.deb

echo "Everything that the application loads is there"
inside sh -c 'find /opt/faceedit -name "*.so*" -type f' | while read -r library; do
	inside env LD_LIBRARY_PATH=/opt/faceedit/_internal ldd "$library" 2>/dev/null |
		sed -n "s|^\s*\(.*\) => not found|$library: \1|p"
done | sort -u >"$root/missing"
cat "$root/missing"
[ ! -s "$root/missing" ] || fail "libraries are missing"

echo "Commands without a screen"
inside faceedit --version
take=/opt/faceedit/_internal/faceedit_app/shipped/assets/demo_take.csv
inside faceedit info "$take"
inside faceedit render "$take" -o /face.png

echo "The window, on a virtual screen"
install xvfb python3
inside python3 /smoke_test.py faceedit --keep /smoke
"$reference" apply "$root$take" "$root/smoke/window/edits.json" -o "$root/expected.csv"
cmp "$root/expected.csv" "$root/smoke/window/edited.csv"
echo "The export is that of $reference"

echo "Removing"
inside apt-get -qq purge -y faceedit >/dev/null 2>&1
inside sh -c 'cd / && find bin etc lib* opt sbin usr 2>/dev/null | sort' >"$root/after"
left=$(comm -13 "$root/before" "$root/after" | grep -i faceedit || true)
[ -z "$left" ] || fail "left behind: $left"
echo "try-deb: passed"
