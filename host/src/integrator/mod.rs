//! Light transport in scalar code: for scenes with surfaces, and for what packets do not do.
