//! Vectors and matrices of three, on single numbers or on several side by side.
//!
//! nalgebra builds its results in memory that is not initialised; with [`Lanes`](super::real::Lanes) the compiler does
//! not see through that, and a sum of two vectors waits for stores that straddle its loads. Plain fields stay in
//! registers.

use std::ops::{Add, AddAssign, Index, IndexMut, Mul, Neg, Sub, SubAssign};

use super::real::Real;

#[derive(Clone, Copy, Debug)]
pub(in crate::reduced) struct Vector3<T> {
    pub x: T,
    pub y: T,
    pub z: T,
}

impl<T: Real> Vector3<T> {
    #[inline(always)]
    pub(in crate::reduced) fn new(x: T, y: T, z: T) -> Vector3<T> {
        Vector3 { x, y, z }
    }

    #[inline(always)]
    pub(in crate::reduced) fn zeros() -> Vector3<T> {
        Vector3::new(T::of(0.0), T::of(0.0), T::of(0.0))
    }

    #[inline(always)]
    pub(in crate::reduced) fn of(v: &nalgebra::Vector3<f64>) -> Vector3<T> {
        Vector3::new(T::of(v.x), T::of(v.y), T::of(v.z))
    }

    #[inline(always)]
    pub(in crate::reduced) fn cross(&self, b: &Vector3<T>) -> Vector3<T> {
        Vector3::new(self.y * b.z - self.z * b.y, self.z * b.x - self.x * b.z, self.x * b.y - self.y * b.x)
    }

    #[inline(always)]
    pub(in crate::reduced) fn dot(&self, b: &Vector3<T>) -> T {
        self.x * b.x + self.y * b.y + self.z * b.z
    }

    #[inline(always)]
    pub(in crate::reduced) fn write(&self, out: &mut [T]) {
        (out[0], out[1], out[2]) = (self.x, self.y, self.z);
    }
}

macro_rules! elementwise {
    ($($operator:ident $apply:ident $assigning:ident $assign:ident),*) => {$(
        impl<T: Real> $operator for Vector3<T> {
            type Output = Vector3<T>;
            #[inline(always)]
            fn $apply(self, b: Vector3<T>) -> Vector3<T> {
                Vector3::new(
                    $operator::$apply(self.x, b.x),
                    $operator::$apply(self.y, b.y),
                    $operator::$apply(self.z, b.z),
                )
            }
        }

        impl<T: Real> $assigning for Vector3<T> {
            #[inline(always)]
            fn $assign(&mut self, b: Vector3<T>) {
                *self = $operator::$apply(*self, b);
            }
        }
    )*};
}

elementwise!(Add add AddAssign add_assign, Sub sub SubAssign sub_assign);

impl<T: Real> Mul<T> for Vector3<T> {
    type Output = Vector3<T>;
    #[inline(always)]
    fn mul(self, factor: T) -> Vector3<T> {
        Vector3::new(self.x * factor, self.y * factor, self.z * factor)
    }
}

impl<T: Real> Neg for Vector3<T> {
    type Output = Vector3<T>;
    #[inline(always)]
    fn neg(self) -> Vector3<T> {
        Vector3::new(-self.x, -self.y, -self.z)
    }
}

impl<T> Index<usize> for Vector3<T> {
    type Output = T;
    #[inline(always)]
    fn index(&self, i: usize) -> &T {
        match i {
            0 => &self.x,
            1 => &self.y,
            _ => &self.z,
        }
    }
}

impl<T> IndexMut<usize> for Vector3<T> {
    #[inline(always)]
    fn index_mut(&mut self, i: usize) -> &mut T {
        match i {
            0 => &mut self.x,
            1 => &mut self.y,
            _ => &mut self.z,
        }
    }
}

/// By its columns.
#[derive(Clone, Copy, Debug)]
pub(in crate::reduced) struct Matrix3<T> {
    pub columns: [Vector3<T>; 3],
}

impl<T: Real> Matrix3<T> {
    #[inline(always)]
    pub(in crate::reduced) fn from_columns(columns: [Vector3<T>; 3]) -> Matrix3<T> {
        Matrix3 { columns }
    }

    #[inline(always)]
    pub(in crate::reduced) fn zeros() -> Matrix3<T> {
        Matrix3 { columns: [Vector3::zeros(); 3] }
    }

    #[inline(always)]
    pub(in crate::reduced) fn identity() -> Matrix3<T> {
        let (o, i) = (T::of(0.0), T::of(1.0));
        Matrix3::from_columns([Vector3::new(i, o, o), Vector3::new(o, i, o), Vector3::new(o, o, i)])
    }

    #[inline(always)]
    pub(in crate::reduced) fn of(m: &nalgebra::Matrix3<f64>) -> Matrix3<T> {
        let column = |k: usize| Vector3::new(T::of(m[(0, k)]), T::of(m[(1, k)]), T::of(m[(2, k)]));
        Matrix3::from_columns([column(0), column(1), column(2)])
    }

    #[inline(always)]
    pub(in crate::reduced) fn column(&self, k: usize) -> &Vector3<T> {
        &self.columns[k]
    }

    /// `M v`
    #[inline(always)]
    pub(in crate::reduced) fn times(&self, v: &Vector3<T>) -> Vector3<T> {
        let [x, y, z] = &self.columns;
        Vector3::new(
            x.x * v.x + y.x * v.y + z.x * v.z,
            x.y * v.x + y.y * v.y + z.y * v.z,
            x.z * v.x + y.z * v.y + z.z * v.z,
        )
    }

    /// `M^T v`
    #[inline(always)]
    pub(in crate::reduced) fn transpose_times(&self, v: &Vector3<T>) -> Vector3<T> {
        let [x, y, z] = &self.columns;
        Vector3::new(x.dot(v), y.dot(v), z.dot(v))
    }

    /// Axes turned about their own z axis by an angle of this sine and cosine.
    #[inline(always)]
    pub(in crate::reduced) fn turned_about_z(&self, (s, c): (T, T)) -> Matrix3<T> {
        let [x, y, z] = self.columns;
        Matrix3::from_columns([x * c + y * s, y * c - x * s, z])
    }

    /// `M N`
    #[inline(always)]
    pub(in crate::reduced) fn product(&self, n: &Matrix3<T>) -> Matrix3<T> {
        let [x, y, z] = &n.columns;
        Matrix3::from_columns([self.times(x), self.times(y), self.times(z)])
    }
}
