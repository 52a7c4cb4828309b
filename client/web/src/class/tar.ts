// tar: archives in the format ustar (POSIX.1-1988), which every system can unpack. Pure functions.

const block = 512, name_bytes_max = 100;

export interface ArchivedFile {
  name: string; // at most 100 bytes
  content: Uint8Array;
}

/** The parts of an archive, in order.
 *
 *  changed_s  the time of the files, in seconds since 1970 */
export function tar_of(files: readonly ArchivedFile[], changed_s: number): Uint8Array[] {
  const parts = files.flatMap(
    ({name, content}) =>
      [header_of(name, content.length, changed_s), content,
       new Uint8Array((block - (content.length % block)) % block)]);
  return [...parts, new Uint8Array(2 * block)];
}

function header_of(name: string, size: number, changed_s: number): Uint8Array {
  const header = new Uint8Array(block), encoder = new TextEncoder(), name_bytes = encoder.encode(name);
  if (name_bytes.length > name_bytes_max) {
    throw new RangeError(`the name ${name} is too long for an archive`);
  }
  const write = (text: string, at: number): void => header.set(encoder.encode(text), at);
  const octal = (number: number, digits: number): string => Math.floor(number).toString(8).padStart(digits, "0") + "\0";
  header.set(name_bytes, 0);
  write(octal(0o644, 7), 100); // mode
  write(octal(0, 7), 108); // owner
  write(octal(0, 7), 116); // group
  write(octal(size, 11), 124);
  write(octal(changed_s, 11), 136);
  write(" ".repeat(8), 148); // the checksum counts as spaces
  write("0", 156); // a file
  write(
    "ustar\0" +
      "00",
    257);
  const sum = header.reduce((total, byte) => total + byte, 0);
  write(sum.toString(8).padStart(6, "0") + "\0 ", 148);
  return header;
}
