// The region that holds a share of a two-dimensional Gaussian: half axes sqrt(q * eigenvalue), q the chi-square quantile with two
// degrees of freedom, -2 ln(1 - share).

export interface Ellipse { major: number; minor: number; angle: number }   // metres; radians, counter-clockwise from the x axis

export interface Covariance { xx_m2: number; xy_m2: number; yy_m2: number }

export function ellipseOf({ xx_m2: a, xy_m2: b, yy_m2: c }: Covariance, share: number): Ellipse {
  const quantile = -2 * Math.log(1 - share);
  const middle = (a + c) / 2;
  const spread = Math.hypot((a - c) / 2, b);
  const axis = (eigenvalue: number) => Math.sqrt(quantile * Math.max(eigenvalue, 0));
  return { major: axis(middle + spread), minor: axis(middle - spread), angle: 0.5 * Math.atan2(2 * b, a - c) };
}

/// The ellipse with the covariance's shape and the area of a circle of the calibrated radius: the server's radii were checked against
/// real walks, the covariance alone was not.
export function calibratedEllipse(covariance: Covariance, radius: number): Ellipse {
  const { major, minor, angle } = ellipseOf(covariance, 0.68);
  if (!(major > 0)) return { major: radius, minor: radius, angle: 0 };
  const flattened = Math.max(minor / major, 0.15);
  return { major: radius / Math.sqrt(flattened), minor: radius * Math.sqrt(flattened), angle };
}
