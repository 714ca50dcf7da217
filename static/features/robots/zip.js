// Writes a zip of files (PKWARE's APPNOTE, without Zip64), which the robots of folders are sent as.

const [LOCAL, CENTRAL, END] = [0x04034b50, 0x02014b50, 0x06054b50];
const [LOCAL_BYTES, CENTRAL_BYTES, END_BYTES] = [30, 46, 22];
const [STORED, DEFLATED] = [0, 8];
const VERSION = 20;
const UTF8_NAMES = 0x0800;
/** 1 January 1980, the first date there is: the same files are always the same zip. */
const DATE = 0x0021;

const CRC_POLYNOMIAL = 0xedb88320;
const CRC_TABLE = Uint32Array.from({ length: 256 }, (_, byte) => {
  let crc = byte;
  for (let bit = 0; bit < 8; bit += 1) crc = crc & 1 ? (crc >>> 1) ^ CRC_POLYNOMIAL : crc >>> 1;
  return crc;
});

/** The CRC-32 of bytes. @param {Uint8Array} bytes */
export function crc32(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) crc = CRC_TABLE[(crc ^ byte) & 0xff] ^ (crc >>> 8);
  return (crc ^ 0xffffffff) >>> 0;
}

/** @param {Uint8Array<ArrayBuffer>} bytes */
async function deflated(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new CompressionStream("deflate-raw"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/**
 * A record of little-endian numbers of two or four bytes.
 * @type {(size: number, fields: [number, 2 | 4][]) => Uint8Array<ArrayBuffer>}
 */
function record(size, fields) {
  const view = new DataView(new ArrayBuffer(size));
  let at = 0;
  for (const [value, width] of fields) {
    if (width === 2) view.setUint16(at, value, true);
    else view.setUint32(at, value, true);
    at += width;
  }
  return new Uint8Array(view.buffer);
}

/**
 * A zip of files, each deflated where that makes it smaller.
 * @param {{ path: string, data: Blob }[]} files
 * @returns {Promise<Blob>}
 */
export async function zipOf(files) {
  const contents = /** @type {Uint8Array<ArrayBuffer>[]} */ ([]);
  const directory = /** @type {Uint8Array<ArrayBuffer>[]} */ ([]);
  let [at, directoryBytes] = [0, 0];
  for (const { path, data } of files) {
    const [name, bytes] = [new TextEncoder().encode(path), new Uint8Array(await data.arrayBuffer())];
    const packed = await deflated(bytes);
    const isSmaller = packed.length < bytes.length;
    const stored = isSmaller ? packed : bytes;
    /** What both headers have. @type {[number, 2 | 4][]} */
    const common = [
      [VERSION, 2], [UTF8_NAMES, 2], [isSmaller ? DEFLATED : STORED, 2], [0, 2], [DATE, 2], [crc32(bytes), 4],
      [stored.length, 4], [bytes.length, 4], [name.length, 2], [0, 2],
    ];
    contents.push(record(LOCAL_BYTES, [[LOCAL, 4], ...common]), name, stored);
    directory.push(record(CENTRAL_BYTES, [
      [CENTRAL, 4], [VERSION, 2], ...common, [0, 2], [0, 2], [0, 2], [0, 4], [at, 4],
    ]), name);
    at += LOCAL_BYTES + name.length + stored.length;
    directoryBytes += CENTRAL_BYTES + name.length;
  }
  const count = files.length;
  const end = record(END_BYTES, [
    [END, 4], [0, 2], [0, 2], [count, 2], [count, 2], [directoryBytes, 4], [at, 4], [0, 2],
  ]);
  return new Blob([...contents, ...directory, end], { type: "application/zip" });
}
