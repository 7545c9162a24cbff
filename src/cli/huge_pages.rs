//! A global allocator that asks Linux for huge pages for large blocks.
//!
//! The system hands out memory page by page, at the first access to each. A million shapes take 250 MB, and with pages of 4 KiB that is a
//! tenth of the time of their first frame. With the setting `madvise` of transparent huge pages, Linux gives pages of 2 MiB only to programs
//! that ask.

use std::alloc::{GlobalAlloc, Layout, System};

/// The system's allocator, with advice on large blocks.
pub(crate) struct HugePages;

/// Minimum number of bytes of a block in huge pages: at this size, the last one wastes at most half of the block.
const LARGE: usize = 4 << 20;

#[expect(unsafe_code, reason = "an allocator")]
// SAFETY: all blocks are the system's, and advice on their pages changes no byte.
unsafe impl GlobalAlloc for HugePages {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promises are passed on, here and below.
        advised(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above.
        advised(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as above.
        advised(unsafe { System.realloc(block, layout, size) }, size)
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(block, layout) }
    }
}

/// Returns the block, after asking for huge pages if it is large. Nothing is lost if there are none.
#[expect(unsafe_code, reason = "only the system knows the pages")]
fn advised(block: *mut u8, size: usize) -> *mut u8 {
    /// Size of a page, or a multiple of it.
    const PAGE: usize = 1 << 16;
    if size >= LARGE && !block.is_null() {
        let skipped = block.align_offset(PAGE);
        // SAFETY: the advice is on whole pages within the block, and leaves their contents as they are.
        unsafe {
            libc::madvise(block.add(skipped).cast(), (size - skipped) / PAGE * PAGE, libc::MADV_HUGEPAGE);
        }
    }
    block
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    /// Returns whether the mapping that contains an address is one for huge pages; `None` if the system has none.
    fn asks_for_huge_pages(address: usize) -> Option<bool> {
        let maps = fs::read_to_string("/proc/self/smaps").unwrap();
        let mut is_here = false;
        for line in maps.lines() {
            let range = line.split(' ').next().and_then(|range| range.split_once('-'));
            if let Some((start, end)) = range
                && let (Ok(start), Ok(end)) =
                    (usize::from_str_radix(start, 16), usize::from_str_radix(end, 16))
            {
                is_here = (start..end).contains(&address);
            } else if let Some(flags) = line.strip_prefix("VmFlags:").filter(|_| is_here) {
                return fs::exists("/sys/kernel/mm/transparent_hugepage")
                    .unwrap()
                    .then(|| flags.contains(" hg"));
            }
        }
        panic!("no mapping has {address:x}");
    }

    #[test]
    fn large_blocks_keep_their_bytes_and_ask_for_huge_pages() {
        let mut block = vec![0_u64; 3 * LARGE / 8];
        assert!(block.iter().all(|number| *number == 0));
        assert_ne!(asks_for_huge_pages(block.as_ptr().addr() + LARGE), Some(false));
        for (number, index) in block.iter_mut().zip(0..) {
            *number = index;
        }
        block.extend(0..LARGE as u64);
        block.truncate(2 * LARGE / 8);
        block.shrink_to_fit();
        assert!((0..).zip(&block).all(|(index, number)| *number == index));
    }
}
