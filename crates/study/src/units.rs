//! Units in which the numbers of a brake are.

/// System of units that belong together. Time is in seconds in each, so that frequencies and growth rates have one unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Units {
    /// m, kg, s, N, Pa.
    #[default]
    Si,
    /// mm, t, s, N, MPa.
    MmTonneSecond,
}

impl Units {
    /// The systems, all of them.
    pub const ALL: [Self; 2] = [Self::Si, Self::MmTonneSecond];

    /// Name in case files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Si => "SI",
            Self::MmTonneSecond => "mm-t-s",
        }
    }

    /// The unit that this system has in the place of one of SI; what has neither a length nor a mass in it stays.
    #[must_use]
    pub fn of(self, si: &str) -> &str {
        match (self, si) {
            (Self::Si, _) => si,
            (Self::MmTonneSecond, "kg") => "t",
            (Self::MmTonneSecond, "m") => "mm",
            (Self::MmTonneSecond, "N/m") => "N/mm",
            (Self::MmTonneSecond, "N/m^3") => "N/mm^3",
            (Self::MmTonneSecond, "Ns/m") => "Ns/mm",
            (Self::MmTonneSecond, "kgm^2") => "tmm^2",
            (Self::MmTonneSecond, "Nm/rad") => "Nmm/rad",
            (Self::MmTonneSecond, "Nms/rad") => "Nmms/rad",
            (Self::MmTonneSecond, "m/s") => "mm/s",
            (Self::MmTonneSecond, "1/m") => "1/mm",
            (Self::MmTonneSecond, "s/m") => "s/mm",
            (Self::MmTonneSecond, "Pa") => "MPa",
            (Self::MmTonneSecond, "kg/m^3") => "t/mm^3",
            (Self::MmTonneSecond, _) => si,
        }
    }

    /// Unit of lengths, m.
    #[must_use]
    pub const fn length(self) -> f64 {
        match self {
            Self::Si => 1.0,
            Self::MmTonneSecond => 1e-3,
        }
    }

    /// Unit of densities, kg/m^3.
    #[must_use]
    pub const fn density(self) -> f64 {
        match self {
            Self::Si => 1.0,
            Self::MmTonneSecond => 1e12,
        }
    }
}
