//! Files in a USDZ, which is a ZIP whose files are not compressed.

/// The bytes of a file in a package, or of its first layer if no name is given.
///
/// # Errors
/// Why there are none, in words.
pub(super) fn entry(package: &[u8], name: &str) -> Result<Vec<u8>, String> {
    let found = entries(package)?.into_iter().find(|(known, _)| known == name);
    found.map(|(_, bytes)| bytes.to_vec()).ok_or_else(|| format!("the package has no {name}"))
}

/// The name of the first layer, which is that of the whole.
pub(super) fn first(package: &[u8]) -> Result<String, String> {
    let is_layer = |name: &str| [".usd", ".usda", ".usdc"].iter().any(|end| name.ends_with(end));
    let found = entries(package)?.into_iter().find(|(name, _)| is_layer(name));
    found.map(|(name, _)| name).ok_or_else(|| "it has no .usd, .usda or .usdc in it".to_owned())
}

/// Most files in a package.
const MOST_ENTRIES: usize = 10_000;

/// All files, in the order of its list.
fn entries(package: &[u8]) -> Result<Vec<(String, &[u8])>, String> {
    let broken = || "it is not a valid USDZ: its list of files is damaged".to_owned();
    let two = |at: usize| Some(usize::from(u16::from_le_bytes(package.get(at..at.checked_add(2)?)?.try_into().ok()?)));
    let four = |at: usize| Some(u32::from_le_bytes(package.get(at..at.checked_add(4)?)?.try_into().ok()?) as usize);
    let far = package.len().saturating_sub(22 + 0xffff);
    let end = (far..package.len().saturating_sub(21)).rev().find(|&at| package[at..].starts_with(b"PK\x05\x06"));
    let end = end.ok_or_else(|| "it is not a valid USDZ: it is no ZIP".to_owned())?;
    let (count, mut at) = (two(end + 10).ok_or_else(broken)?, four(end + 16).ok_or_else(broken)?);
    if count > MOST_ENTRIES {
        return Err(format!("it has {count} files: at most {MOST_ENTRIES} are read"));
    }
    let mut all = Vec::new();
    for _ in 0..count {
        let one = || {
            let is_entry = package.get(at..at.checked_add(4)?)? == b"PK\x01\x02";
            let (method, size) = (two(at + 10)?, four(at + 24)?);
            let [name, extra, comment] = [28, 30, 32].map(|k| two(at + k));
            let (name, extra, comment) = (name?, extra?, comment?);
            let text = String::from_utf8(package.get(at + 46..at + 46 + name)?.to_vec()).ok()?;
            let local = four(at + 42)?;
            let start = local.checked_add(30 + two(local.checked_add(26)?)? + two(local.checked_add(28)?)?)?;
            let bytes = package.get(start..start.checked_add(size)?)?;
            is_entry.then_some((text, method, bytes, 46 + name + extra + comment))
        };
        let (name, method, bytes, length) = one().ok_or_else(broken)?;
        if method != 0 {
            return Err(format!("{name} in it is compressed, which a USDZ must not be: pack it again"));
        }
        all.push((name, bytes));
        at += length;
    }
    Ok(all)
}
