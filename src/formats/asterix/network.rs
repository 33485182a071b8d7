//! From a captured packet to what its UDP datagram carries: link layer, VLAN tags, IPv4 (RFC 791), IPv6 (RFC 8200), UDP
//! (RFC 768). Link types are those of tcpdump.org/linktypes.

use super::capture::Content;

/// What an interface captured.
#[derive(Clone, Copy)]
pub enum Network {
    Ethernet,
    Ip,
    /// Four octets of a protocol family first.
    Loopback,
    Cooked,
    Cooked2,
    Unknown,
}

impl Network {
    pub fn of(link_type: u16) -> Self {
        match link_type {
            1 => Network::Ethernet,
            12 | 14 | 101 | 228 | 229 => Network::Ip,
            0 | 108 => Network::Loopback,
            113 => Network::Cooked,
            276 => Network::Cooked2,
            _ => Network::Unknown,
        }
    }
}

const OTHER: Content = Content::Foreign("packet other than UDP");
const IP_V4: u16 = 0x0800;
const IP_V6: u16 = 0x86dd;
const UDP: u8 = 17;

/// What the UDP datagram of a packet carries, as far as it was captured. The first fragment of a datagram is what is there
/// of it, later ones are cut.
pub fn udp_payload(packet: &[u8], network: Network) -> Content<'_> {
    match link_payload(packet, network) {
        Some(octets) => match octets.first().map(|first| first >> 4) {
            Some(4) => of_ip_v4(octets).unwrap_or(Content::Cut),
            Some(6) => of_ip_v6(octets).unwrap_or(Content::Cut),
            _ => OTHER,
        },
        None => OTHER,
    }
}

/// What begins with the header of IP.
fn link_payload(packet: &[u8], network: Network) -> Option<&[u8]> {
    let (protocol_at, mut start) = match network {
        Network::Ip => return Some(packet),
        Network::Loopback => return packet.get(4..),
        Network::Unknown => return None,
        Network::Ethernet => (12, 14),
        Network::Cooked => (14, 16),
        Network::Cooked2 => (0, 20),
    };
    let mut protocol = number(packet, protocol_at)?;
    // Tags of VLANs, one within another.
    while let 0x8100 | 0x88a8 | 0x9100 = protocol {
        protocol = number(packet, start + 2)?;
        start += 4;
    }
    matches!(protocol, IP_V4 | IP_V6)
        .then(|| packet.get(start..))
        .flatten()
}

fn number(octets: &[u8], at: usize) -> Option<u16> {
    let two: [u8; 2] = octets.get(at..at + 2)?.try_into().ok()?;
    Some(u16::from_be_bytes(two))
}

fn of_ip_v4(octets: &[u8]) -> Option<Content<'_>> {
    if *octets.get(9)? != UDP {
        return Some(OTHER);
    }
    let header = usize::from(octets[0] & 0x0f) * 4;
    let is_later_fragment = number(octets, 6)? & 0x1fff != 0;
    if header < 20 || is_later_fragment {
        return Some(Content::Cut);
    }
    // A length of 0 is left to the network card.
    let total = match usize::from(number(octets, 2)?) {
        0 => octets.len(),
        total => total.min(octets.len()),
    };
    of_udp(octets.get(header..total)?)
}

fn of_ip_v6(octets: &[u8]) -> Option<Content<'_>> {
    let mut next = *octets.get(6)?;
    let mut rest = octets.get(40..)?;
    let length = usize::from(number(octets, 4)?);
    if length > 0 {
        rest = &rest[..length.min(rest.len())];
    }
    loop {
        let header = match next {
            UDP => return of_udp(rest),
            // Hop-by-hop, routing, destination options.
            0 | 43 | 60 => usize::from(*rest.get(1)?) * 8 + 8,
            44 if number(rest, 2)? & 0xfff8 != 0 => return Some(Content::Cut),
            44 => 8,
            _ => return Some(OTHER),
        };
        next = rest[0];
        rest = rest.get(header..)?;
    }
}

fn of_udp(octets: &[u8]) -> Option<Content<'_>> {
    let length = usize::from(number(octets, 4)?);
    let payload = octets.get(8..)?;
    let payload = match length.checked_sub(8) {
        Some(length) => &payload[..length.min(payload.len())],
        None => payload,
    };
    Some(if payload.is_empty() {
        Content::Foreign("empty datagram")
    } else {
        Content::Octets(payload)
    })
}
