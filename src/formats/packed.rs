//! Files as they are packed: gzip and Zstandard are unpacked, UTF-16 and stated encodings become UTF-8, while the file is read.

use super::FormatOptions;
use crate::model::fault::Fault;
use encoding_rs::{CoderResult, Decoder, Encoding, UTF_8};
use flate2::bufread::MultiGzDecoder;
use ruzstd::decoding::StreamingDecoder;
use std::cell::Cell;
use std::io::{self, BufRead, BufReader, ErrorKind, Read};
use std::rc::Rc;

const GZIP: &[u8] = b"\x1f\x8b";
const ZSTD: &[u8] = b"\x28\xb5\x2f\xfd";
/// Bytes that any file may unpack to, and how many times its own size beyond.
pub(super) const FREE_BYTES: u64 = 64 << 20;
pub(super) const MOST_TIMES: u64 = 200;
const BUFFER_BYTES: usize = 1 << 16;

/// The unpacked text or bytes of a file.
///
/// # Errors
/// A broken head of a packed file; an encoding that nobody knows.
pub(super) fn open<'a>(
    input: &'a mut dyn BufRead,
    options: &FormatOptions,
) -> Result<Box<dyn BufRead + 'a>, Vec<Fault>> {
    let encoding = match options.get::<String>("encoding") {
        Some(name) => Some(encoding_named(&name)?),
        None => None,
    };
    let mut unpacked = unpack(input).map_err(|error| {
        let detail = format!("the packed file cannot be read: {error}");
        vec![Fault::new("/file", "malformed", detail)]
    })?;
    let head = unpacked.fill_buf().unwrap_or_default();
    let found = encoding.or_else(|| Encoding::for_bom(head).map(|(found, _)| found));
    Ok(match found.filter(|found| *found != UTF_8) {
        Some(found) => Box::new(BufReader::with_capacity(
            BUFFER_BYTES,
            Decoded::new(unpacked, found.new_decoder()),
        )),
        None => unpacked,
    })
}

fn encoding_named(name: &str) -> Result<&'static Encoding, Vec<Fault>> {
    Encoding::for_label(name.as_bytes()).ok_or_else(|| {
        let detail = format!("'{name}' is no encoding");
        let allowed =
            "a label of the WHATWG encoding standard, such as utf-8, windows-1252, utf-16le";
        vec![Fault::new("/meta/encoding", "unknown_value", detail).allowing(allowed)]
    })
}

fn unpack<'a>(input: &'a mut dyn BufRead) -> io::Result<Box<dyn BufRead + 'a>> {
    let head = input.fill_buf()?;
    let (is_gzip, is_zstd) = (head.starts_with(GZIP), head.starts_with(ZSTD));
    let taken = Rc::new(Cell::new(0));
    let counting = Counting {
        input,
        taken: Rc::clone(&taken),
    };
    if is_gzip {
        return Ok(bounded(MultiGzDecoder::new(counting), taken));
    }
    if is_zstd {
        let decoder = StreamingDecoder::new(counting).map_err(io::Error::other)?;
        return Ok(bounded(decoder, taken));
    }
    Ok(Box::new(counting.input))
}

fn bounded<'a>(unpacked: impl Read + 'a, taken: Rc<Cell<u64>>) -> Box<dyn BufRead + 'a> {
    let bounded = Bounded {
        unpacked,
        taken,
        given: 0,
    };
    Box::new(BufReader::with_capacity(BUFFER_BYTES, bounded))
}

/// Counts what is taken of the packed file.
struct Counting<'a> {
    input: &'a mut dyn BufRead,
    taken: Rc<Cell<u64>>,
}

impl Read for Counting<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.input.read(buffer)?;
        self.taken.set(self.taken.get() + count as u64);
        Ok(count)
    }
}

impl BufRead for Counting<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.input.fill_buf()
    }

    fn consume(&mut self, count: usize) {
        self.taken.set(self.taken.get() + count as u64);
        self.input.consume(count);
    }
}

/// Fails where a small file unpacks to one that no sound file has.
struct Bounded<R> {
    unpacked: R,
    taken: Rc<Cell<u64>>,
    given: u64,
}

impl<R: Read> Read for Bounded<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.unpacked.read(buffer)?;
        self.given += count as u64;
        if self.given > FREE_BYTES + MOST_TIMES * self.taken.get() {
            let detail = format!("it unpacks to more than {MOST_TIMES} times its size");
            return Err(io::Error::new(ErrorKind::InvalidData, detail));
        }
        Ok(count)
    }
}

/// Text of another encoding as UTF-8; what is no text of it becomes U+FFFD.
struct Decoded<'a> {
    input: Box<dyn BufRead + 'a>,
    decoder: Decoder,
    ready: Vec<u8>,
    given: usize,
    is_done: bool,
}

impl<'a> Decoded<'a> {
    fn new(input: Box<dyn BufRead + 'a>, decoder: Decoder) -> Self {
        Decoded {
            input,
            decoder,
            ready: Vec::new(),
            given: 0,
            is_done: false,
        }
    }

    fn decode_more(&mut self) -> io::Result<()> {
        self.given = 0;
        self.ready.resize(BUFFER_BYTES, 0);
        let bytes = self.input.fill_buf()?;
        let is_last = bytes.is_empty();
        let (result, read, written, _) =
            self.decoder.decode_to_utf8(bytes, &mut self.ready, is_last);
        self.is_done = is_last && result == CoderResult::InputEmpty;
        self.ready.truncate(written);
        self.input.consume(read);
        Ok(())
    }
}

impl Read for Decoded<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while self.given == self.ready.len() && !self.is_done {
            self.decode_more()?;
        }
        let count = buffer.len().min(self.ready.len() - self.given);
        buffer[..count].copy_from_slice(&self.ready[self.given..self.given + count]);
        self.given += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::Compression;
    use flate2::write::GzEncoder;
    use std::io::Write;

    fn read(bytes: &[u8], encoding: Option<&str>) -> io::Result<String> {
        let mut options = FormatOptions::default();
        options.add("encoding", &encoding);
        let mut input = bytes;
        let mut text = String::new();
        let mut opened = open(&mut input, &options).expect("a known encoding");
        opened.read_to_string(&mut text).map(|_| text)
    }

    fn gzip(bytes: &[u8]) -> Vec<u8> {
        let mut packed = GzEncoder::new(Vec::new(), Compression::best());
        packed.write_all(bytes).unwrap();
        packed.finish().unwrap()
    }

    #[test]
    fn packed_and_encoded_texts_are_read() {
        let text = "time_s,Größe\n1,2\n";
        let utf16: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        let with_mark = [b"\xff\xfe".as_slice(), &utf16].concat();
        let latin = b"time_s,Gr\xf6\xdfe\n1,2\n";
        // A frame of one raw block that ends it (RFC 8878, 3.1.1).
        let size = text.len() as u8;
        let head = [
            0x28,
            0xb5,
            0x2f,
            0xfd,
            0x20,
            size,
            (size << 3) | 1,
            size >> 5,
            0,
        ];
        let zstd = [&head, text.as_bytes()].concat();
        assert_eq!(read(text.as_bytes(), None).unwrap(), text);
        assert_eq!(read(&gzip(text.as_bytes()), None).unwrap(), text);
        assert_eq!(read(&gzip(&with_mark), None).unwrap(), text);
        assert_eq!(read(latin, Some("windows-1252")).unwrap(), text);
        assert_eq!(read(&zstd, None).unwrap(), text);
        let two = [gzip(b"a,b\n"), gzip(b"1,2\n")].concat();
        assert_eq!(read(&two, None).unwrap(), "a,b\n1,2\n");
    }

    #[test]
    fn a_bomb_is_refused_and_a_cut_file_is_an_error() {
        let bomb = gzip(&vec![b'0'; 128 << 20]);
        assert!(bomb.len() < 200_000);
        let error = read(&bomb, None).unwrap_err();
        assert!(error.to_string().contains("200 times"), "{error}");
        let packed = gzip(b"time_s,x_m\n1,2\n");
        assert!(read(&packed[..packed.len() - 9], None).is_err());
    }
}
