//! A hash table from indices of cells or points to places in a list. Code that iterates over it sorts what it gets, so
//! results cannot depend on its order.

#[derive(Debug, Clone, Default)]
pub(super) struct Lookup {
    slots: Vec<Slot>,
    used: usize,
}

#[derive(Debug, Clone, Copy)]
struct Slot {
    key: [i64; 2],
    place: u32,
}

const FREE: u32 = u32::MAX;

#[inline]
fn hash([i, j]: [i64; 2]) -> u64 {
    // The multipliers of splitmix64's finaliser (Vigna).
    let mut h = (i as u64).wrapping_mul(0xbf58_476d_1ce4_e5b9) ^ (j as u64).wrapping_mul(0x94d0_49bb_1331_11eb);
    h ^= h >> 29;
    h = h.wrapping_mul(0xbf58_476d_1ce4_e5b9);
    h ^ (h >> 32)
}

impl Lookup {
    #[inline]
    pub(super) fn get(&self, key: [i64; 2]) -> Option<u32> {
        if self.slots.is_empty() {
            return None;
        }
        let slot = &self.slots[self.find(key)];
        (slot.place != FREE).then_some(slot.place)
    }

    /// The slot of the key, or the free slot where it belongs; at least a quarter of the slots are free.
    #[inline]
    fn find(&self, key: [i64; 2]) -> usize {
        let mask = self.slots.len() - 1;
        let mut at = hash(key) as usize & mask;
        while self.slots[at].place != FREE && self.slots[at].key != key {
            at = (at + 1) & mask;
        }
        at
    }

    pub(super) fn insert(&mut self, key: [i64; 2], place: u32) {
        if 4 * (self.used + 1) > 3 * self.slots.len() {
            let larger = vec![Slot { key: [0; 2], place: FREE }; (2 * self.slots.len()).max(64)];
            for slot in std::mem::replace(&mut self.slots, larger) {
                if slot.place != FREE {
                    let at = self.find(slot.key);
                    self.slots[at] = slot;
                }
            }
        }
        let at = self.find(key);
        self.used += usize::from(self.slots[at].place == FREE);
        self.slots[at] = Slot { key, place };
    }

    /// In no meaningful order.
    pub(super) fn keys(&self) -> impl Iterator<Item = [i64; 2]> {
        self.slots.iter().filter(|slot| slot.place != FREE).map(|slot| slot.key)
    }

    pub(super) fn bytes(&self) -> usize {
        self.slots.len() * size_of::<Slot>()
    }
}
