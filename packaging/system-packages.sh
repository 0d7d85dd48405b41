#!/bin/sh
# The system libraries that Qt, offscreen OpenGL and sound need on Linux, and espeak-ng for synthesis.
# Installs what is missing through apt-get where that is possible; otherwise prints the line to run.
set -eu

[ "$(uname -s)" = Linux ] || exit 0

# package:file that shows it is there (a shared library, a plug-in folder or a program)
NEEDED="
python3-venv:@venv
libegl1:libEGL.so.1
libegl-mesa0:libEGL_mesa.so.0
libgl1:libGL.so.1
libgl1-mesa-dri:@dri
libxrender1:libXrender.so.1
libosmesa6:libOSMesa.so.8
libxkbcommon-x11-0:libxkbcommon-x11.so.0
libxcb-cursor0:libxcb-cursor.so.0
libxcb-icccm4:libxcb-icccm.so.4
libxcb-image0:libxcb-image.so.0
libxcb-keysyms1:libxcb-keysyms.so.1
libxcb-randr0:libxcb-randr.so.0
libxcb-render-util0:libxcb-render-util.so.0
libxcb-shape0:libxcb-shape.so.0
libxcb-xinerama0:libxcb-xinerama.so.0
libxcb-xkb1:libxcb-xkb.so.1
libdbus-1-3:libdbus-1.so.3
libfontconfig1:libfontconfig.so.1
libglib2.0-0:libglib-2.0.so.0
libportaudio2:libportaudio.so.2
fonts-dejavu-core:@fonts
espeak-ng:@espeak
"

# Distributions without apt have all of it with their desktop, or name it differently.
libraries=$( (ldconfig -p || /sbin/ldconfig -p) 2>/dev/null || true)

present() {
	case "$1" in
	@venv) "${PYTHON:-python3}" -c 'import ensurepip, venv' 2>/dev/null ;;
	@dri) ls /usr/lib/*/dri/*_dri.so /usr/lib/dri/*_dri.so /usr/lib64/dri/*_dri.so 2>/dev/null | grep -q . ;;
	@fonts) ls /usr/share/fonts 2>/dev/null | grep -q . ;;
	@espeak) command -v espeak-ng >/dev/null ;;
	*) printf '%s\n' "$libraries" | grep -qF "$1 " ;;
	esac
}

missing=""
for entry in $NEEDED; do
	present "${entry#*:}" || missing="$missing ${entry%%:*}"
done
[ -n "$missing" ] || exit 0

line="apt-get install -y --no-install-recommends$missing"
if command -v apt-get >/dev/null && [ "$(id -u)" = 0 ]; then
	echo "Installing system libraries:$missing"
	apt-get update -qq
	DEBIAN_FRONTEND=noninteractive $line -qq >/dev/null
elif command -v apt-get >/dev/null && command -v sudo >/dev/null && sudo -n true 2>/dev/null; then
	echo "Installing system libraries:$missing"
	sudo apt-get update -qq
	sudo DEBIAN_FRONTEND=noninteractive $line -qq >/dev/null
else
	echo "FaceEdit misses system libraries:$missing"
	echo "On Debian or Ubuntu run:  sudo $line"
	echo "Going on without them; the window or the 3-D view may not open."
fi
