//! Packets of a capture: pcap (libpcap's savefile format) and pcapng (draft-ietf-opsawg-pcapng). Any other file is one
//! payload as it is.

use super::network::{Network, udp_payload};

/// What one packet, or a file that is no capture, carries.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Payload<'a> {
    pub content: Content<'a>,
    /// When it was captured (Unix seconds).
    pub captured_s: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Content<'a> {
    Octets(&'a [u8]),
    /// Nothing that could be read, by the name of what is counted.
    Foreign(&'static str),
    /// Cut before anything of it.
    Cut,
}

/// Order of octets in the numbers of a capture.
#[derive(Clone, Copy)]
struct Order {
    is_little: bool,
}

impl Order {
    fn u32(self, octets: &[u8], at: usize) -> Option<u32> {
        let four: [u8; 4] = octets.get(at..at.checked_add(4)?)?.try_into().ok()?;
        Some(if self.is_little {
            u32::from_le_bytes(four)
        } else {
            u32::from_be_bytes(four)
        })
    }

    fn u16(self, octets: &[u8], at: usize) -> Option<u16> {
        let two: [u8; 2] = octets.get(at..at.checked_add(2)?)?.try_into().ok()?;
        Some(if self.is_little {
            u16::from_le_bytes(two)
        } else {
            u16::from_be_bytes(two)
        })
    }
}

/// What stands at the front of a capture.
enum Form {
    /// No capture; whether its one payload is still to come.
    Bare(bool),
    Pcap {
        order: Order,
        ticks_per_s: f64,
        network: Network,
    },
    /// What is known of the interfaces of the section.
    PcapNg {
        order: Order,
        interfaces: Vec<Interface>,
    },
}

#[derive(Clone, Copy)]
struct Interface {
    network: Network,
    snap_length: u32,
    ticks_per_s: f64,
    offset_s: f64,
}

const SECTION: u32 = 0x0a0d_0d0a;
const INTERFACE: u32 = 1;
const OLD_PACKET: u32 = 2;
const SIMPLE_PACKET: u32 = 3;
const ENHANCED_PACKET: u32 = 6;
const TIME_RESOLUTION: u16 = 9;
const TIME_OFFSET: u16 = 14;

/// Payloads in the order of the file.
pub struct Payloads<'a> {
    rest: &'a [u8],
    form: Form,
}

pub fn payloads(file: &[u8]) -> Payloads<'_> {
    let (form, start) = told(file).unwrap_or((Form::Bare(true), 0));
    Payloads {
        rest: &file[start..],
        form,
    }
}

/// The form of a capture, and where its packets begin.
fn told(file: &[u8]) -> Option<(Form, usize)> {
    let big = Order { is_little: false };
    if big.u32(file, 0)? == SECTION {
        let order = section_order(file)?;
        let interfaces = Vec::new();
        return Some((Form::PcapNg { order, interfaces }, 0));
    }
    let (is_little, ticks_per_s) = match big.u32(file, 0)? {
        0xa1b2_c3d4 => (false, 1e6),
        0xd4c3_b2a1 => (true, 1e6),
        0xa1b2_3c4d => (false, 1e9),
        0x4d3c_b2a1 => (true, 1e9),
        _ => return None,
    };
    let order = Order { is_little };
    // The upper bits say how many octets of a checksum end a packet.
    let network = Network::of((order.u32(file, 20)? & 0xffff) as u16);
    let form = Form::Pcap {
        order,
        ticks_per_s,
        network,
    };
    Some((form, 24))
}

fn section_order(block: &[u8]) -> Option<Order> {
    match (Order { is_little: false }).u32(block, 8)? {
        0x1a2b_3c4d => Some(Order { is_little: false }),
        0x4d3c_2b1a => Some(Order { is_little: true }),
        _ => None,
    }
}

impl<'a> Iterator for Payloads<'a> {
    type Item = Payload<'a>;

    fn next(&mut self) -> Option<Payload<'a>> {
        if let Form::Bare(is_there) = &mut self.form {
            return std::mem::take(is_there).then_some(Payload {
                content: Content::Octets(self.rest),
                captured_s: None,
            });
        }
        while !self.rest.is_empty() {
            let Some(found) = self.step() else {
                // What follows a broken header cannot be found.
                self.rest = &[];
                return Some(Payload {
                    content: Content::Cut,
                    captured_s: None,
                });
            };
            if found.is_some() {
                return found;
            }
        }
        None
    }
}

impl<'a> Payloads<'a> {
    /// The next packet; `Some(None)` for what is none, `None` where the file breaks off.
    fn step(&mut self) -> Option<Option<Payload<'a>>> {
        match self.form {
            Form::Bare(_) => None,
            Form::Pcap {
                order,
                ticks_per_s,
                network,
            } => {
                let head = self.take(16)?;
                let length = order.u32(head, 8)? as usize;
                let ticks = f64::from(order.u32(head, 4)?) / ticks_per_s;
                let packet = self.take(length.min(self.rest.len()))?;
                Some(Some(Payload {
                    content: udp_payload(packet, network),
                    captured_s: Some(f64::from(order.u32(head, 0)?) + ticks),
                }))
            }
            Form::PcapNg { .. } => {
                self.start_section()?;
                self.block()
            }
        }
    }

    fn take(&mut self, length: usize) -> Option<&'a [u8]> {
        let (head, rest) = self.rest.split_at_checked(length)?;
        self.rest = rest;
        Some(head)
    }

    /// A new section has an order of octets, and interfaces, of its own.
    fn start_section(&mut self) -> Option<()> {
        let is_section = Order { is_little: false }.u32(self.rest, 0)? == SECTION;
        if is_section {
            self.form = Form::PcapNg {
                order: section_order(self.rest)?,
                interfaces: Vec::new(),
            };
        }
        Some(())
    }

    /// One block of pcapng: type, length of all of it, body, length again.
    fn block(&mut self) -> Option<Option<Payload<'a>>> {
        let Form::PcapNg { order, .. } = self.form else {
            return None;
        };
        let kind = order.u32(self.rest, 0)?;
        let length = order.u32(self.rest, 4)? as usize;
        if length < 12 || !length.is_multiple_of(4) {
            return None;
        }
        let body = self.take(length)?.get(8..length - 4)?;
        let Form::PcapNg { interfaces, .. } = &mut self.form else {
            return None;
        };
        match kind {
            INTERFACE => {
                interfaces.push(interface(body, order)?);
                Some(None)
            }
            ENHANCED_PACKET | OLD_PACKET | SIMPLE_PACKET => {
                Some(Some(packet(kind, body, order, interfaces)?))
            }
            _ => Some(None),
        }
    }
}

fn interface(body: &[u8], order: Order) -> Option<Interface> {
    let mut found = Interface {
        network: Network::of(order.u16(body, 0)?),
        snap_length: order.u32(body, 4)?,
        ticks_per_s: 1e6,
        offset_s: 0.0,
    };
    let mut rest = body.get(8..)?;
    while let (Some(code), Some(length)) = (order.u16(rest, 0), order.u16(rest, 2)) {
        let length = usize::from(length);
        let Some(value) = rest.get(4..4 + length) else {
            break;
        };
        match (code, value) {
            (0, _) => break,
            (TIME_RESOLUTION, [resolution]) => {
                let base: f64 = if resolution & 0x80 != 0 { 2.0 } else { 10.0 };
                found.ticks_per_s = base.powi(i32::from(resolution & 0x7f));
            }
            (TIME_OFFSET, [_, _, _, _, _, _, _, _]) => {
                let (first, second) = (order.u32(value, 0)?, order.u32(value, 4)?);
                let (high, low) = if order.is_little {
                    (second, first)
                } else {
                    (first, second)
                };
                found.offset_s = ((u64::from(high) << 32 | u64::from(low)) as i64) as f64;
            }
            _ => {}
        }
        rest = rest.get(4 + length.next_multiple_of(4)..)?;
    }
    Some(found)
}

fn packet<'a>(
    kind: u32,
    body: &'a [u8],
    order: Order,
    interfaces: &[Interface],
) -> Option<Payload<'a>> {
    let number = match kind {
        ENHANCED_PACKET => order.u32(body, 0)? as usize,
        OLD_PACKET => usize::from(order.u16(body, 0)?),
        _ => 0,
    };
    let interface = interfaces.get(number)?;
    if kind == SIMPLE_PACKET {
        let octets = body.get(4..)?;
        let mut length = order.u32(body, 0)?;
        if interface.snap_length > 0 {
            length = length.min(interface.snap_length);
        }
        let octets = &octets[..octets.len().min(length as usize)];
        return Some(Payload {
            content: udp_payload(octets, interface.network),
            captured_s: None,
        });
    }
    let ticks = u64::from(order.u32(body, 4)?) << 32 | u64::from(order.u32(body, 8)?);
    let octets = body.get(20..)?;
    let length = octets.len().min(order.u32(body, 12)? as usize);
    Some(Payload {
        content: udp_payload(&octets[..length], interface.network),
        captured_s: Some(interface.offset_s + ticks as f64 / interface.ticks_per_s),
    })
}
