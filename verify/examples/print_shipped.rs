fn main() { print!("{}", cede_verify::lemma::shipped()); }
