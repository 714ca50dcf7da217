#!/bin/sh
# Start the server of a Space, whose host name is in SPACE_HOST.
set -eu
# The page of the hub shows the Space in a frame, where cookies need this to be an HTTPS address.
[ -z "${SPACE_HOST:-}" ] || export HEXAPODS_PUBLIC_URL="${HEXAPODS_PUBLIC_URL:-https://$SPACE_HOST}"
if [ -z "${HEXAPODS_TOKEN:-}" ]; then
    # A demo needs an operator, here one that nobody is.
    HEXAPODS_TOKEN=$(python -c 'import secrets; print(secrets.token_hex(16))')
    export HEXAPODS_TOKEN
    echo "The secret HEXAPODS_TOKEN is not set, so that nobody is operator." >&2
fi
exec hexapods "${@:-serve}"
