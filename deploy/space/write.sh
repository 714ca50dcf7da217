#!/bin/sh
# Write the files of a Space on Hugging Face into a folder, which may be a clone of it:
#
#     git clone https://huggingface.co/spaces/OWNER/NAME ../space
#     sh deploy/space/write.sh ../space
#     cd ../space && git add --all && git commit --message "Update" && git push
set -eu
if [ $# -ne 1 ] || [ ! -d "$1" ]; then
    echo "usage: sh deploy/space/write.sh FOLDER, of a folder that is there" >&2
    exit 2
fi
folder=$(cd "$1" && pwd)
cd "$(dirname "$0")/../.."
# What the Dockerfile copies, which .dockerignore lists.
sed -n 's/^!//p' .dockerignore | while read -r pattern; do
    # Unquoted, as some are patterns of names.
    tar --exclude=__pycache__ -cf - $pattern | tar -xf - -C "$folder"
done
cat Dockerfile deploy/space/Dockerfile.end > "$folder/Dockerfile"
cp .dockerignore deploy/space/README.md deploy/space/start-space.sh "$folder"
echo '!start-space.sh' >> "$folder/.dockerignore"
