#![doc = include_str!("../script/language.md")]
