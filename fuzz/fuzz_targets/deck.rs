//! Any bytes are either a mesh whose cells and sets have its nodes, or an error of one line: `cargo fuzz run deck fuzz/seeds/deck`.
#![no_main]

use std::collections::BTreeSet;

use formats::{Limits, read_deck};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    // Decks are read from files; one for each process.
    let path = std::env::temp_dir().join(format!("deck-{}.inp", std::process::id()));
    std::fs::write(&path, bytes).expect("a temporary file");
    let limits = Limits { bytes: 1 << 20, entries: 1 << 16, order: 1 << 16 };
    match read_deck(&path, &limits) {
        Ok(deck) => {
            let labels: BTreeSet<i64> = deck.mesh.nodes.iter().map(|node| node.label).collect();
            assert_eq!(labels.len(), deck.mesh.nodes.len());
            assert!(deck.mesh.nodes.iter().all(|node| node.position.iter().all(|x| x.is_finite())));
            assert!(deck.sets.values().flatten().all(|node| labels.contains(node)));
        }
        Err(error) => {
            let message = error.to_string();
            assert!(!message.contains('\n') && message.len() < 1500, "{message}");
        }
    }
});
