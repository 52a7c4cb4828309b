// CRC-32 as computed by zlib, eight bytes at a time (slicing-by-8; Kounavis & Berry 2005).

const tables = make_tables();

function make_tables(): Uint32Array[] {
  const tables = Array.from({length: 8}, () => new Uint32Array(256));
  for (let byte = 0; byte < 256; ++byte) {
    let value = byte;
    for (let bit = 0; bit < 8; ++bit) {
      value = value & 1 ? value >>> 1 ^ 0xedb88320 : value >>> 1;
    }
    tables[0][byte] = value;
  }
  for (let byte = 0; byte < 256; ++byte) {
    for (let k = 1; k < 8; ++k) {
      const before = tables[k - 1][byte];
      tables[k][byte] = before >>> 8 ^ tables[0][before & 255];
    }
  }
  return tables;
}

const [t0, t1, t2, t3, t4, t5, t6, t7] = tables;

/** Returns the checksum of the bytes. before: the checksum of the bytes that precede them. */
export function crc32(bytes: Uint8Array, before = 0): number {
  let crc = ~before, i = 0;
  const length = bytes.length, end = length - 7;
  for (; i < end; i += 8) {
    crc ^= bytes[i] | bytes[i + 1] << 8 | bytes[i + 2] << 16 | bytes[i + 3] << 24;
    crc = t7[crc & 255] ^ t6[crc >>> 8 & 255] ^ t5[crc >>> 16 & 255] ^ t4[crc >>> 24] ^ t3[bytes[i + 4]] ^
      t2[bytes[i + 5]] ^ t1[bytes[i + 6]] ^ t0[bytes[i + 7]];
  }
  for (; i < length; ++i) {
    crc = crc >>> 8 ^ t0[(crc ^ bytes[i]) & 255];
  }
  return ~crc >>> 0;
}
