//! Numbers in words of charts, pages and tables.

/// `4.6e-6`: two digits.
pub fn short(x: f64) -> String {
    format!("{x:.1e}")
}

/// `10⁻⁶`
pub(crate) fn power_of_ten(exponent: i32) -> String {
    format!("10{}", superscript(exponent))
}

/// `4.6 × 10⁻⁶`; numbers from 0.01 to 9999 as they are, to two digits.
pub fn written(x: f64) -> String {
    if x == 0.0 {
        return "0".to_string();
    }
    if (0.01..10_000.0).contains(&x.abs()) {
        return plain(x, 2);
    }
    let text = format!("{x:.1e}");
    match text.split_once('e').map(|(mantissa, exponent)| (mantissa, exponent.parse())) {
        Some((mantissa, Ok(exponent))) => format!("{mantissa} × 10{}", superscript(exponent)),
        _ => text,
    }
}

/// A value of a parameter in few letters: `10⁻⁷`, `3`, `−π`, `0.05`.
pub(crate) fn compact(value: f64) -> String {
    let (size, sign) = (value.abs(), if value < 0.0 { "−" } else { "" });
    if (size - std::f64::consts::PI).abs() < 1e-12 {
        return format!("{sign}π");
    }
    let exponent = size.log10().round();
    let is_power = (size / 10f64.powf(exponent) - 1.0).abs() < 1e-9;
    match size {
        0.05..5000.0 | 0.0 => format!("{sign}{}", plain(size, 3)),
        _ if is_power => format!("{sign}{}", power_of_ten(exponent as i32)),
        _ => format!("{sign}{}", written(size)),
    }
}

/// A duration in the unit that suits it: `10 ms`, `0.5 ms`, `2 s`.
pub fn duration(seconds: f64) -> String {
    let (value, unit) = match seconds {
        s if s >= 0.1 => (s, "s"),
        s if s >= 1e-4 => (1e3 * s, "ms"),
        s => (1e6 * s, "µs"),
    };
    format!("{} {unit}", plain(value, 4))
}

/// A positive number to so many significant digits without an exponent and without trailing zeros.
pub fn plain(x: f64, digits: usize) -> String {
    let magnitude = if x == 0.0 { 0 } else { x.abs().log10().floor() as i32 };
    let decimals = (digits as i32 - 1 - magnitude).max(0) as usize;
    let text = format!("{x:.decimals$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_string(),
        false => text,
    }
}

/// Two decimals; no zero has a sign.
pub(crate) fn two_decimals(x: f64) -> String {
    let text = format!("{x:.2}");
    if text == "-0.00" { "0.00".to_string() } else { text }
}

const SUPERSCRIPTS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];

fn superscript(n: i32) -> String {
    n.to_string()
        .chars()
        .map(|c| match c {
            '-' => '⁻',
            digit => SUPERSCRIPTS[digit.to_digit(10).unwrap_or(0) as usize],
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_parameters_are_short() {
        let words = [-1e6, -std::f64::consts::PI, 0.0, 1e-12, 0.05, 3.0, 2000.0, 1e7].map(compact);
        assert_eq!(words, ["−10⁶", "−π", "0", "10⁻¹²", "0.05", "3", "2000", "10⁷"]);
    }

    #[test]
    fn numbers_read_well() {
        assert_eq!([power_of_ten(-12), power_of_ten(0), power_of_ten(3)], ["10⁻¹²", "10⁰", "10³"]);
        assert_eq!(
            [written(4.63e-6), written(0.0123), written(1234.0), written(3.0)],
            ["4.6 × 10⁻⁶", "0.012", "1234", "3"]
        );
        assert_eq!(
            [duration(0.01), duration(5e-4), duration(2.0), duration(1e-5)],
            ["10 ms", "0.5 ms", "2 s", "10 µs"]
        );
        assert_eq!([two_decimals(-0.004), two_decimals(-0.006), two_decimals(7.046)], ["0.00", "-0.01", "7.05"]);
        assert_eq!([plain(10_000.0, 2), plain(0.25, 2), plain(9.999, 2)], ["10000", "0.25", "10"]);
    }
}
