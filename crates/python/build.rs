//! What a linker must know of a module whose interpreter is there when it is loaded: of macOS alone.

fn main() {
    pyo3_build_config::add_extension_module_link_args();
}
