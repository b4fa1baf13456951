//! A saved state as bytes, for another process or another day.
//!
//! The model writes its own part; around it come the life's few fields and a checksum, so that bytes that were
//! truncated, damaged or are of another kind are found out before anything is changed.

use super::stepping::Slope;
use super::{Interface, Lifecycle, Phase, Refusal};

/// First bytes of every saved state, with the version of this format.
const MAGIC: &[u8; 8] = b"BKFMUST1";

const PHASES: [Phase; 8] = [
    Phase::Instantiated,
    Phase::Initialization,
    Phase::Step,
    Phase::Intermediate,
    Phase::Event,
    Phase::ContinuousTime,
    Phase::Terminated,
    Phase::Failed,
];

const INTERFACES: [Interface; 3] =
    [Interface::CoSimulation { events: false }, Interface::CoSimulation { events: true }, Interface::ModelExchange];

impl Lifecycle {
    /// The whole state as bytes.
    ///
    /// # Errors
    /// [`Refusal::Failed`] where the model cannot write its part.
    pub fn to_bytes(&self) -> Result<Vec<u8>, Refusal> {
        let mut bytes = MAGIC.to_vec();
        let place = |found: Option<usize>| found.and_then(|place| u8::try_from(place).ok()).unwrap_or(u8::MAX);
        bytes.push(place(INTERFACES.iter().position(|other| *other == self.interface)));
        bytes.push(place(PHASES.iter().position(|other| *other == self.phase)));
        bytes.push(u8::from(self.stale));
        for value in [self.start, self.stop.unwrap_or(f64::NAN), self.clock] {
            bytes.extend(value.to_le_bytes());
        }
        bytes.push(u8::from(self.ended.is_some()));
        put_block(&mut bytes, self.ended.as_deref().unwrap_or_default().as_bytes());
        bytes.extend((self.slopes.len() as u64).to_le_bytes());
        for slope in &self.slopes {
            bytes.extend((slope.reference as u64).to_le_bytes());
            bytes.extend(slope.order.to_le_bytes());
            bytes.extend(slope.value.to_le_bytes());
        }
        put_block(&mut bytes, &self.model.serialise()?);
        let sum = checksum(&bytes);
        bytes.extend(sum.to_le_bytes());
        Ok(bytes)
    }

    /// The state that [`to_bytes`](Self::to_bytes) wrote, of this instance or one like it, here or in another
    /// process.
    ///
    /// # Errors
    /// [`Refusal::Bytes`] for bytes of another kind, truncated or damaged ones; [`Refusal::Failed`] for bytes of
    /// another model.
    pub fn from_bytes(&self, bytes: &[u8]) -> Result<Self, Refusal> {
        let (content, sum) = bytes.split_last_chunk::<8>().ok_or(Refusal::Bytes("too short"))?;
        if u64::from_le_bytes(*sum) != checksum(content) {
            return Err(Refusal::Bytes("truncated or damaged, the checksum does not fit"));
        }
        let mut rest = Reader(content);
        if rest.take(MAGIC.len())? != MAGIC {
            return Err(Refusal::Bytes("of another program or version"));
        }
        let interface = *INTERFACES.get(usize::from(rest.byte()?)).ok_or(UNKNOWN)?;
        if interface != self.interface {
            return Err(Refusal::Bytes("of an instance of the other interface type"));
        }
        let mut life = self.clone();
        life.phase = *PHASES.get(usize::from(rest.byte()?)).ok_or(UNKNOWN)?;
        life.stale = rest.byte()? != 0;
        life.start = rest.number()?;
        let stop = rest.number()?;
        life.stop = (!stop.is_nan()).then_some(stop);
        life.clock = rest.number()?;
        let ended = rest.byte()? != 0;
        let reason = String::from_utf8_lossy(rest.block()?).into_owned();
        life.ended = ended.then_some(reason);
        life.slopes = rest.slopes(life.model.description().entries.len())?;
        life.model.deserialise(rest.block()?)?;
        life.fresh = false;
        if rest.0.is_empty() { Ok(life) } else { Err(Refusal::Bytes("longer than a state")) }
    }
}

const UNKNOWN: Refusal = Refusal::Bytes("of another program or version");

fn put_block(bytes: &mut Vec<u8>, block: &[u8]) {
    bytes.extend((block.len() as u64).to_le_bytes());
    bytes.extend(block);
}

/// Fowler, Noll and Vo's hash (FNV-1a, 64 bits): enough to detect accidental damage.
fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}

/// Reads from the front.
struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], Refusal> {
        let (front, rest) = self.0.split_at_checked(count).ok_or(Refusal::Bytes("too short"))?;
        self.0 = rest;
        Ok(front)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], Refusal> {
        let (front, rest) = self.0.split_first_chunk::<N>().ok_or(Refusal::Bytes("too short"))?;
        self.0 = rest;
        Ok(*front)
    }

    fn byte(&mut self) -> Result<u8, Refusal> {
        self.array::<1>().map(|[byte]| byte)
    }

    fn number(&mut self) -> Result<f64, Refusal> {
        self.array().map(f64::from_le_bytes)
    }

    fn size(&mut self) -> Result<usize, Refusal> {
        usize::try_from(u64::from_le_bytes(self.array()?)).map_err(|_| Refusal::Bytes("too long"))
    }

    fn block(&mut self) -> Result<&'a [u8], Refusal> {
        let size = self.size()?;
        self.take(size)
    }

    fn slopes(&mut self, entries: usize) -> Result<Vec<Slope>, Refusal> {
        let mut slopes = Vec::new();
        for _ in 0..self.size()? {
            let (reference, order) = (self.size()?, u32::from_le_bytes(self.array()?));
            slopes.push(Slope { reference, order, value: self.number()? });
        }
        if slopes.iter().any(|slope| slope.reference >= entries) { Err(UNKNOWN) } else { Ok(slopes) }
    }
}
