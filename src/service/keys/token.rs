//! What a key looks like, and how it is told from a guess. Keys are derived from a master key, so that none is ever stored: who has
//! the tables has no key.

use hmac::{Hmac, KeyInit, Mac};
use sha2::Sha256;
use std::fmt;
use std::sync::Arc;
use uuid::Uuid;

/// A shorter master key could be guessed.
const LEAST_BYTES: usize = 16;
const PREFIX: &str = "tlk_";

/// From which all keys come; who has it may do everything.
#[derive(Clone)]
pub struct MasterKey(Arc<[u8]>);

/// Whose token it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Bearer {
    Master,
    Key(Uuid),
}

impl fmt::Debug for MasterKey {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("MasterKey(not shown)")
    }
}

impl MasterKey {
    /// White space around it is none of it: files end with a line feed.
    ///
    /// # Errors
    /// It is too short, or not printable ASCII, which no header could carry.
    pub fn new(text: &str) -> Result<MasterKey, String> {
        let text = text.trim();
        if !text.bytes().all(|byte| byte.is_ascii_graphic()) {
            return Err("a master key is printable ASCII without spaces".to_owned());
        }
        if text.len() < LEAST_BYTES {
            return Err(format!(
                "the master key has {} bytes; it needs at least {LEAST_BYTES}, such as those of `openssl rand -hex 32`",
                text.len()
            ));
        }
        Ok(MasterKey(text.as_bytes().into()))
    }

    /// HMAC-SHA256 (RFC 2104) of a message for one purpose.
    fn mac(&self, purpose: &str, message: &[u8]) -> Hmac<Sha256> {
        let mut mac = <Hmac<Sha256> as KeyInit>::new_from_slice(&self.0)
            .expect("HMAC takes keys of any length");
        mac.update(purpose.as_bytes());
        mac.update(&[0]);
        mac.update(message);
        mac
    }

    /// The key with this identity.
    pub(super) fn token(&self, id: Uuid) -> String {
        let mac = self.mac("key", id.as_bytes()).finalize().into_bytes();
        format!("{PREFIX}{}_{}", id.simple(), hex(&mac))
    }

    /// Whose it is; `None` of a guess. Both comparisons are always made, each of digests of one length in constant time.
    pub(super) fn whose(&self, token: &str) -> Option<Bearer> {
        let own = self.mac("master", &self.0).finalize().into_bytes();
        let is_master = self.mac("master", token.as_bytes()).verify_slice(&own);
        let (id, mac) = parts(token).unwrap_or_default();
        let is_key = self.mac("key", id.as_bytes()).verify_slice(&mac);
        match (is_master, is_key) {
            (Ok(()), _) => Some(Bearer::Master),
            (Err(_), Ok(())) => Some(Bearer::Key(id)),
            (Err(_), Err(_)) => None,
        }
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn parts(token: &str) -> Option<(Uuid, [u8; 32])> {
    let (id, digits) = token.strip_prefix(PREFIX)?.split_once('_')?;
    if digits.len() != 64 || !digits.bytes().all(|byte| byte.is_ascii_hexdigit()) {
        return None;
    }
    let mut mac = [0; 32];
    for (index, byte) in mac.iter_mut().enumerate() {
        *byte = u8::from_str_radix(digits.get(2 * index..2 * index + 2)?, 16).ok()?;
    }
    Some((Uuid::try_parse(id).ok()?, mac))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_the_hmac_that_python_computes() {
        let master = MasterKey::new("0123456789abcdef\n").unwrap();
        let id = Uuid::from_u128(1);
        // hmac.new(b"0123456789abcdef", b"key\0" + bytes(15) + b"\1", "sha256").hexdigest()
        let wanted = "9eae775a1a78a390a1408fc67cc6917785b70536254bca8f33e66fd21eeb5fac";
        assert_eq!(
            master.token(id),
            format!("tlk_00000000000000000000000000000001_{wanted}")
        );
    }

    #[test]
    fn a_key_is_known_and_a_guess_is_not() {
        let master = MasterKey::new("0123456789abcdef").unwrap();
        let id = Uuid::now_v7();
        let token = master.token(id);
        assert_eq!(master.whose(&token), Some(Bearer::Key(id)));
        assert_eq!(master.whose("0123456789abcdef"), Some(Bearer::Master));
        let other = MasterKey::new("0123456789abcdeg").unwrap();
        assert_eq!(other.whose(&token), None);
        let mut changed = token.clone();
        changed.replace_range(
            token.len() - 1..,
            if token.ends_with('0') { "1" } else { "0" },
        );
        for wrong in [
            "",
            "tlk_",
            "0123456789abcde",
            &changed,
            &token[..token.len() - 1],
        ] {
            assert_eq!(master.whose(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn a_master_key_is_long_and_goes_into_a_header() {
        assert!(MasterKey::new("0123456789abcde").is_err());
        assert!(MasterKey::new("0123456789 abcdef").is_err());
        assert_eq!(
            format!("{:?}", MasterKey::new(&"x".repeat(16)).unwrap()),
            "MasterKey(not shown)"
        );
    }
}
