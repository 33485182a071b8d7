//! Captures and frames of recorders, laid out by hand around blocks that the encoder wrote.

use super::{ignored, read, rejected, sound, units};
use trackloom_domain::formats::asterix::Told;
use trackloom_domain::formats::asterix::encode::{PlotRecord, encode_plots, encode_plots_001};
use trackloom_domain::model::time::TimeBase;

/// 45 826.101 s of a day.
const OF_DAY_S: f64 = 45_826.0;
/// 25 February 2014, midnight.
const DAY_S: u32 = 1_393_286_400;

fn plot(time_s: f64) -> PlotRecord {
    PlotRecord {
        source: (25, 201),
        time_s,
        place: Some((18_520.0, 1.0)),
        detection: 2,
        is_simulated: false,
        is_test: false,
        is_tentative: false,
        ends: false,
        mode_a: Some(0o1234),
        level_ft: Some(10_000.0),
        address: None,
        callsign: None,
        number: None,
        motion: None,
    }
}

/// Two blocks of one plot each.
fn two_blocks() -> [Vec<u8>; 2] {
    [OF_DAY_S, OF_DAY_S + 0.5].map(|time_s| encode_plots(&[plot(time_s)]))
}

fn assert_both(file: &[u8], framing: &str) {
    let decoded = sound(file, &Told::default());
    assert_eq!((decoded.framing, units(&decoded)), (framing, 2));
    let times: Vec<f64> = decoded
        .feed
        .reports
        .iter()
        .map(|report| report.time_s)
        .collect();
    assert_eq!(times, [OF_DAY_S, OF_DAY_S + 0.5]);
}

fn oradis(block: &[u8], ms: u32) -> Vec<u8> {
    [
        &(block.len() as u16 + 6).to_be_bytes()[..],
        &ms.to_be_bytes(),
        block,
    ]
    .concat()
}

fn final_frame(block: &[u8], time_cs: u32, sequence: &[u8]) -> Vec<u8> {
    let length = (block.len() + 12 + sequence.len()) as u16;
    let head = [
        &length.to_be_bytes()[..],
        sequence,
        &[0, 1, 2],
        &time_cs.to_be_bytes()[1..],
    ];
    [&head.concat()[..], block, &[0xa5; 4]].concat()
}

#[test]
fn frames_of_recorders_are_told_apart() {
    let [first, second] = two_blocks();
    assert_both(&[&first[..], &second].concat(), "bare blocks");
    assert_both(
        &[oradis(&first, 45_826_101), oradis(&second, 45_826_601)].concat(),
        "ORADIS",
    );
    let finals = [first.clone(), second.clone()].map(|block| final_frame(&block, 4_582_610, &[]));
    assert_both(&finals.concat(), "final");
    let numbered =
        [first.clone(), second.clone()].map(|block| final_frame(&block, 4_582_610, &[0, 0, 0, 9]));
    assert_both(&numbered.concat(), "final with sequence numbers");
    let gps = |block: &[u8]| [block, &[0, 0, 0, 0, 0, 0, 0x59, 0x81, 0, 0]].concat();
    assert_both(&[vec![7; 2200], gps(&first), gps(&second)].concat(), "GPS");
}

#[test]
fn frames_of_comsoft_have_a_text_before_them() {
    let [first, second] = two_blocks();
    let mut head = b"2014-02-25 12:43:46\x002014-02-25 12:44:46\x00".to_vec();
    head.resize(128, 0);
    let little = |block: &[u8]| {
        [
            &[0, 0, 0, 5][..],
            &(block.len() as u16).to_le_bytes(),
            block,
        ]
        .concat()
    };
    let file = [head.clone(), little(&first), little(&second)].concat();
    assert_both(&file, "RFF");
    let big = [
        &[0, 0, 0, 5][..],
        &(first.len() as u16).to_be_bytes(),
        &first,
    ]
    .concat();
    let decoded = sound(&[head, big].concat(), &Told::default());
    assert_eq!(decoded.framing, "RFF with lengths in network order");
}

/// 45 826 s are 89 · 512 + 258.
#[test]
fn frames_complete_truncated_times() {
    let block = encode_plots_001(&[plot(OF_DAY_S)]);
    let framed = [
        oradis(&block, 45_826_101),
        final_frame(&block, 4_582_610, &[]),
    ];
    for file in framed {
        let decoded = sound(&file, &Told::default());
        assert_eq!(decoded.feed.reports[0].time_s, OF_DAY_S);
    }
    let decoded = sound(&block, &Told::default());
    assert_eq!(rejected(&decoded), [("no_time", 1)].into());
}

#[test]
fn what_fits_no_framing_is_refused_with_where_each_broke() {
    let [first, _] = two_blocks();
    let fault = |file: &[u8]| {
        let faults = read(file, &Told::default()).err().expect("no framing fits");
        assert_eq!((faults.len(), faults[0].code.as_str()), (1, "unsupported"));
        faults[0].detail.clone()
    };
    let detail = fault(&[&first[..], &[48, 0]].concat());
    let broken = format!("bare blocks break at octet {}", first.len());
    assert!(
        detail.contains(&broken) && detail.contains("ORADIS break at octet 0"),
        "{detail}"
    );
    assert!(fault(&[48, 0, 3]).contains("bare blocks break at octet 0"));
    let empty = read(&[], &Told::default()).err().expect("nothing is there");
    assert_eq!(empty[0].code, "empty");
}

/// Of a long file 64 KiB are looked at; what breaks later is one unit.
#[test]
fn a_long_file_may_be_cut() {
    let plots: Vec<PlotRecord> = (0..8000)
        .map(|index| plot(OF_DAY_S + f64::from(index)))
        .collect();
    let file = encode_plots(&plots);
    assert!(file.len() > 1 << 16);
    let decoded = sound(&file[..file.len() - 1], &Told::default());
    assert_eq!(rejected(&decoded), [("truncated", 1)].into());
    assert!(decoded.feed.reports.len() > 7800);
}

fn udp(payload: &[u8]) -> Vec<u8> {
    let length = (payload.len() as u16 + 8).to_be_bytes();
    [&[0x22, 0x11, 0x33, 0x44][..], &length, &[0, 0], payload].concat()
}

fn ip_v4(payload: &[u8], fragment: u16) -> Vec<u8> {
    let length = (payload.len() as u16 + 20).to_be_bytes();
    let fragment = fragment.to_be_bytes();
    let head = [
        0x45,
        0,
        length[0],
        length[1],
        0,
        1,
        fragment[0],
        fragment[1],
        1,
        17,
        0,
        0,
    ];
    [&head[..], &[192, 0, 2, 1, 232, 1, 1, 1], payload].concat()
}

/// With a header of destination options before UDP.
fn ip_v6(payload: &[u8]) -> Vec<u8> {
    let length = (payload.len() as u16 + 8).to_be_bytes();
    let head = [0x60, 0, 0, 0, length[0], length[1], 60, 1];
    [&head[..], &[0x20; 32], &[17, 0, 1, 4, 0, 0, 0, 0], payload].concat()
}

fn ethernet(protocol: &[u8], payload: &[u8]) -> Vec<u8> {
    [&[1; 12][..], protocol, payload].concat()
}

/// A capture of packets, the first at 45 826.25 s of the day.
fn pcap(link_type: u32, packets: &[Vec<u8>]) -> Vec<u8> {
    let head = [0xa1b2_c3d4, 0x0002_0004, 0, 0, 65_535, link_type];
    let mut file: Vec<u8> = head
        .iter()
        .flat_map(|number: &u32| number.to_le_bytes())
        .collect();
    // Two numbers of two octets each.
    file[4..8].copy_from_slice(&[2, 0, 4, 0]);
    for packet in packets {
        let length = packet.len() as u32;
        let head = [DAY_S + 45_826, 250_000, length, length];
        file.extend(head.iter().flat_map(|number| number.to_le_bytes()));
        file.extend(packet);
    }
    file
}

fn pcapng(link_type: u16, packets: &[Vec<u8>]) -> Vec<u8> {
    let block = |kind: u32, body: &[u8]| {
        let mut body = body.to_vec();
        body.resize(body.len().next_multiple_of(4), 0);
        let length = (body.len() as u32 + 12).to_be_bytes();
        [&kind.to_be_bytes()[..], &length, &body, &length].concat()
    };
    let section = [&[0x1a, 0x2b, 0x3c, 0x4d, 0, 1, 0, 0][..], &[0xff; 8]].concat();
    // Times in 10⁻⁹ s.
    let options = [0, 9, 0, 1, 9, 0, 0, 0, 0, 0, 0, 0];
    let interface = [&link_type.to_be_bytes()[..], &[0, 0, 0, 0, 0, 0], &options].concat();
    let mut file = [
        block(0x0a0d_0d0a, &section),
        block(1, &interface),
        block(4, &[0; 8]),
    ]
    .concat();
    for packet in packets {
        let ticks = u64::from(DAY_S + 45_826) * 1_000_000_000 + 250_000_000;
        let length = (packet.len() as u32).to_be_bytes();
        let head = [&[0; 4][..], &ticks.to_be_bytes(), &length, &length].concat();
        file.extend(block(6, &[&head[..], packet].concat()));
    }
    file
}

fn assert_captured(file: &[u8], what: &str) {
    let decoded = sound(file, &Told::default());
    assert_eq!(
        (units(&decoded), decoded.time_base),
        (2, TimeBase::Utc),
        "{what}"
    );
    let times: Vec<f64> = decoded
        .feed
        .reports
        .iter()
        .map(|report| report.time_s)
        .collect();
    let day_s = f64::from(DAY_S);
    assert_eq!(times, [day_s + OF_DAY_S, day_s + OF_DAY_S + 0.5], "{what}");
}

#[test]
fn captures_of_every_link_are_read() {
    let [first, second] = two_blocks();
    let both = |packet: &dyn Fn(&[u8]) -> Vec<u8>| vec![packet(&first), packet(&second)];
    let v4 = |payload: &[u8]| ip_v4(&udp(payload), 0);
    let cases: Vec<(&str, u16, Vec<Vec<u8>>)> = vec![
        ("Ethernet", 1, both(&|block| ethernet(&[8, 0], &v4(block)))),
        (
            "VLAN",
            1,
            both(&|block| ethernet(&[0x81, 0, 0, 5, 8, 0], &v4(block))),
        ),
        (
            "two VLANs",
            1,
            both(&|block| ethernet(&[0x88, 0xa8, 0, 5, 0x81, 0, 0, 6, 8, 0], &v4(block))),
        ),
        (
            "IPv6",
            1,
            both(&|block| ethernet(&[0x86, 0xdd], &ip_v6(&udp(block)))),
        ),
        ("raw IP", 101, both(&v4)),
        (
            "cooked",
            113,
            both(&|block| [&[0; 14][..], &[8, 0], &v4(block)].concat()),
        ),
        (
            "cooked 2",
            276,
            both(&|block| [&[8, 0][..], &[0; 18], &v4(block)].concat()),
        ),
        (
            "loopback",
            0,
            both(&|block| [&[2, 0, 0, 0][..], &v4(block)].concat()),
        ),
        (
            "loopback of OpenBSD",
            108,
            both(&|block| [&[0, 0, 0, 2][..], &v4(block)].concat()),
        ),
    ];
    for (what, link, packets) in cases {
        assert_captured(&pcap(u32::from(link), &packets), what);
        assert_captured(&pcapng(link, &packets), what);
    }
}

#[test]
fn other_packets_and_fragments_have_their_fates() {
    let [first, second] = two_blocks();
    let datagram = udp(&[&first[..], &second].concat());
    let half = 8 + first.len() + 5;
    let tcp = {
        let mut packet = ip_v4(&datagram, 0);
        packet[9] = 6;
        packet
    };
    let packets = [
        ip_v4(&udp(&encode_plots(&[plot(OF_DAY_S - 1.0)])), 0),
        ip_v4(&datagram[..half], 0x2000),
        ip_v4(&datagram[half..], 7),
        tcp,
        ip_v4(&udp(&[]), 0),
        ip_v4(&udp(&[1, 2]), 0),
    ];
    let decoded = sound(&pcap(101, &packets), &Told::default());
    assert_eq!(decoded.feed.reports.len(), 2);
    // The second block of the first fragment, the second fragment, what is no block.
    assert_eq!(rejected(&decoded), [("truncated", 3)].into());
    assert_eq!(
        ignored(&decoded),
        [("empty datagram", 1), ("packet other than UDP", 1)].into()
    );
    assert_eq!(units(&decoded), 7);
}

#[test]
fn a_cut_capture_keeps_what_is_before() {
    let [first, second] = two_blocks();
    let file = pcap(101, &[ip_v4(&udp(&first), 0), ip_v4(&udp(&second), 0)]);
    for end in [file.len() - 1, file.len() - second.len() - 30] {
        let decoded = sound(&file[..end], &Told::default());
        assert_eq!(
            (decoded.feed.reports.len(), rejected(&decoded)),
            (1, [("truncated", 1)].into())
        );
    }
    assert!(
        read(&pcap(101, &[]), &Told::default()).err().unwrap()[0]
            .detail
            .contains("UDP")
    );
}
