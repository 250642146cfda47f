//! Materials against closed forms, quadrature and published Fresnel values.
