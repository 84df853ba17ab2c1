//! The packages of the workspace and the packages that they need, as `cargo metadata` lists them.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::error::TaskError;

/// What `cargo metadata` says.
pub(super) struct Packages(Value);

/// A text of a package; empty where it has none.
pub(super) fn text_of<'v>(package: &'v Value, key: &str) -> &'v str {
    package[key].as_str().unwrap_or_default()
}

fn list<'v>(value: &'v Value, key: &str) -> impl Iterator<Item = &'v Value> {
    value[key].as_array().into_iter().flatten()
}

impl Packages {
    /// Asks cargo, which fetches packages of other platforms where they are not there yet.
    ///
    /// # Errors
    /// A cargo that fails.
    pub fn read(root: &Path) -> Result<Self, TaskError> {
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let mut command = Command::new(cargo);
        let output = command
            .args(["metadata", "--format-version", "1", "--locked"])
            .current_dir(root)
            .output()
            .map_err(TaskError::Start)?;
        if !output.status.success() {
            let said = String::from_utf8_lossy(&output.stderr).replace('\n', " ");
            return Err(TaskError::Release(format!("cargo metadata: {said}")));
        }
        let said = serde_json::from_slice(&output.stdout);
        said.map(Self).map_err(|error| TaskError::Release(format!("cargo metadata: {error}")))
    }

    /// The packages of the workspace.
    pub fn own(&self) -> impl Iterator<Item = &Value> {
        let members: BTreeSet<&str> = list(&self.0, "workspace_members").filter_map(Value::as_str).collect();
        list(&self.0, "packages").filter(move |package| members.contains(text_of(package, "id")))
    }

    /// Packages of others that programs or libraries of the workspace are made of, on any platform: what these need themselves, not their tests
    /// and build scripts.
    pub fn in_the_program(&self, names: &[&str]) -> Vec<&Value> {
        let mut waiting: Vec<&str> = self
            .own()
            .filter(|package| names.contains(&text_of(package, "name")))
            .map(|package| text_of(package, "id"))
            .collect();
        let mut reached: BTreeSet<&str> = waiting.iter().copied().collect();
        while let Some(id) = waiting.pop() {
            let node = list(&self.0["resolve"], "nodes").find(|node| text_of(node, "id") == id);
            let needed = node.into_iter().flat_map(|node| list(node, "deps")).filter(|needed| {
                // A dependency of a kind without a name is linked.
                list(needed, "dep_kinds").any(|kind| kind["kind"].is_null())
            });
            for needed in needed.map(|needed| text_of(needed, "pkg")) {
                if reached.insert(needed) {
                    waiting.push(needed);
                }
            }
        }
        list(&self.0, "packages")
            .filter(|package| !package["source"].is_null() && reached.contains(text_of(package, "id")))
            .collect()
    }
}
