//! A proof of a whole property as a text file, which names what it is about by hash.

use super::check::{CheckError, check};
use super::model::Network;
use super::onnx::OnnxError;
use super::proof::{Proof, ProofError};
use super::property::Property;
use super::vnnlib::VnnlibError;
use super::{onnx, vnnlib};
use sha2::{Digest as _, Sha256};
use std::fmt;
use std::path::{Path, PathBuf};

/// First line of the file.
const MAGIC: &str = "cede-certificate 2";

/// A file: where it is, and what is in it.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Source {
    /// Where it was.
    pub path: PathBuf,
    /// The SHA-256 of its bytes, in hexadecimal.
    pub sha256: String,
}

impl Source {
    /// A file with these bytes.
    #[must_use]
    pub fn new(path: &Path, bytes: &[u8]) -> Self {
        let hash = Sha256::digest(bytes);
        Self {
            path: path.to_owned(),
            sha256: hash.iter().map(|byte| format!("{byte:02x}")).collect(),
        }
    }
}

/// A proof that a network has a property: the files of both, and the tree of each query.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Certificate {
    /// The program that wrote it, with its version.
    pub program: String,
    /// The network's file.
    pub onnx: Source,
    /// The property's file.
    pub vnnlib: Source,
    proofs: Vec<Proof>,
}

/// A certificate proves less than the property.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CertificateError {
    /// A file is not the one that the certificate is about.
    #[error("the certificate is about another {what}: sha256 {wanted}, but {path} has {found}")]
    Source {
        /// `network` or `property`.
        what: &'static str,
        /// The file as the certificate names it.
        path: PathBuf,
        /// The certificate's hash.
        wanted: String,
        /// The file's hash.
        found: String,
    },
    /// The network cannot be read.
    #[error("the network: {0}")]
    Network(#[from] OnnxError),
    /// The property cannot be read.
    #[error("the property: {0}")]
    Property(#[from] VnnlibError),
    /// It has not one proof for each query.
    #[error("{proofs} proofs for {queries} queries")]
    Count {
        /// Proofs that there are.
        proofs: usize,
        /// Queries of the property.
        queries: usize,
    },
    /// The property is about a network of another shape.
    #[error("the property and the network do not fit")]
    Shape,
    /// A proof does not convince.
    #[error("query {query}: {source}")]
    Query {
        /// Which query.
        query: usize,
        /// Why.
        source: CheckError,
    },
}

/// What a check has proved, of what. [Displayed](fmt::Display) in sentences.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Proved {
    /// The network's file.
    pub onnx: Source,
    /// Inputs, outputs, layers and weights of the network.
    pub network: [usize; 4],
    /// The property's file.
    pub vnnlib: Source,
    /// Boxes of inputs in the property.
    pub boxes: usize,
    /// Unsafe sets of outputs, over all boxes.
    pub unsafe_sets: usize,
    /// The program that wrote the proof.
    pub program: String,
    /// Regions of the proof that were checked.
    pub regions: usize,
}

impl fmt::Display for Proved {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [inputs, outputs, layers, weights] = self.network;
        let Self {
            onnx,
            vnnlib,
            boxes,
            unsafe_sets,
            program,
            regions,
            ..
        } = self;
        writeln!(
            f,
            "proved: for no input in any of the property's {boxes} boxes is the network's output in one of the \
             box's unsafe sets ({unsafe_sets} in all)"
        )?;
        writeln!(
            f,
            "network:  {} ({inputs} inputs, {outputs} outputs, {layers} layers, {weights} weights), sha256 {}",
            onnx.path.display(),
            onnx.sha256
        )?;
        writeln!(
            f,
            "property: {}, sha256 {}",
            vnnlib.path.display(),
            vnnlib.sha256
        )?;
        write!(
            f,
            "proof:    by {program}; {regions} regions checked by cede-nnv-check {}, in real-number semantics: \
             exact weights, exact decimals, no rounding",
            env!("CARGO_PKG_VERSION")
        )
    }
}

impl Certificate {
    /// A certificate from the proofs of a prover, of which name and version are given.
    #[must_use]
    pub fn new(program: &str, onnx: Source, vnnlib: Source, proofs: Vec<Proof>) -> Self {
        Self {
            program: program.to_owned(),
            onnx,
            vnnlib,
            proofs,
        }
    }

    /// The certificate's text.
    #[must_use]
    pub fn to_text(&self) -> String {
        let mut text = format!(
            "{MAGIC}\nprogram {}\nonnx {}\nonnx-sha256 {}\nvnnlib {}\nvnnlib-sha256 {}\nqueries {}\n",
            self.program,
            self.onnx.path.display(),
            self.onnx.sha256,
            self.vnnlib.path.display(),
            self.vnnlib.sha256,
            self.proofs.len()
        );
        for proof in &self.proofs {
            text.push_str(&proof.to_text());
        }
        text
    }

    /// Reads a certificate. Never panics.
    ///
    /// # Errors
    /// With the line, if the text is not a certificate.
    pub fn from_text(text: &str) -> Result<Self, ProofError> {
        let mut lines = text.lines().enumerate().map(|(i, line)| (i + 1, line));
        let mut head = |line, key: &str, what| {
            let rest = lines.next().and_then(|(_, text)| text.strip_prefix(key));
            rest.ok_or(ProofError { line, what })
        };
        head(
            1,
            MAGIC,
            "not a certificate of Cede, version 2; write it again",
        )?;
        let program = head(2, "program ", "expected: program NAME VERSION")?.to_owned();
        let onnx = Source {
            path: head(3, "onnx ", "expected: onnx FILE")?.into(),
            sha256: head(4, "onnx-sha256 ", "expected: onnx-sha256 HASH")?.to_owned(),
        };
        let vnnlib = Source {
            path: head(5, "vnnlib ", "expected: vnnlib FILE")?.into(),
            sha256: head(6, "vnnlib-sha256 ", "expected: vnnlib-sha256 HASH")?.to_owned(),
        };
        let count = head(7, "queries ", "expected: queries NUMBER")?.parse::<usize>();
        let count = count.map_err(|_| ProofError {
            line: 7,
            what: "expected: queries NUMBER",
        })?;
        let proofs = (0..count)
            .map(|_| Proof::from_lines(&mut lines))
            .collect::<Result<_, _>>()?;
        match lines.next() {
            Some((line, _)) => Err(ProofError {
                line,
                what: "something follows the last proof",
            }),
            None => Ok(Self {
                program,
                onnx,
                vnnlib,
                proofs,
            }),
        }
    }

    /// Checks that the network in these bytes has the property in these, and that they are the ones
    /// that the certificate was written for.
    ///
    /// # Errors
    /// The first thing that does not convince.
    pub fn check(&self, onnx: &[u8], vnnlib: &[u8]) -> Result<Proved, CertificateError> {
        let sources = [
            ("network", &self.onnx, onnx),
            ("property", &self.vnnlib, vnnlib),
        ];
        for (what, source, bytes) in sources {
            let found = Source::new(&source.path, bytes);
            if found.sha256 != source.sha256 {
                return Err(CertificateError::Source {
                    what,
                    path: found.path,
                    wanted: source.sha256.clone(),
                    found: found.sha256,
                });
            }
        }
        let (network, property) = (onnx::read(onnx)?, vnnlib::read_bytes(vnnlib)?);
        let regions = self.check_proofs(&network, &property)?;
        let layers = network.layers();
        let weights = layers.iter().map(|l| l.weights.data().len()).sum();
        let queries = &property.queries;
        Ok(Proved {
            onnx: self.onnx.clone(),
            network: [network.inputs(), network.outputs(), layers.len(), weights],
            vnnlib: self.vnnlib.clone(),
            boxes: queries.len(),
            unsafe_sets: queries.iter().map(|q| q.unsafe_set.len()).sum(),
            program: self.program.clone(),
            regions,
        })
    }

    /// Checks that the proofs show that a network has a property, whatever files they were written
    /// for; gives the number of regions.
    ///
    /// # Errors
    /// The first thing that does not convince.
    pub fn check_proofs(
        &self,
        network: &Network,
        property: &Property,
    ) -> Result<usize, CertificateError> {
        if (network.inputs(), network.outputs()) != (property.inputs, property.outputs) {
            return Err(CertificateError::Shape);
        }
        let (proofs, queries) = (self.proofs.len(), property.queries.len());
        if proofs != queries {
            return Err(CertificateError::Count { proofs, queries });
        }
        let pairs = property.queries.iter().zip(&self.proofs).enumerate();
        pairs
            .map(|(query, (q, proof))| {
                check(network, q, proof).map_err(|source| CertificateError::Query { query, source })
            })
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const TEXT: &str = "cede-certificate 2\nprogram p 1\nonnx a.onnx\nonnx-sha256 0a\nvnnlib b.vnnlib\nvnnlib-sha256 0b\nqueries 0\n";

    #[test]
    fn a_head_is_read() {
        let read = Certificate::from_text(TEXT).expect("well formed");
        assert_eq!(read.to_text(), TEXT);
        assert_eq!(read.program, "p 1");
        assert_eq!(read.onnx.path, Path::new("a.onnx"));
        let endless = TEXT.replace("queries 0", "queries 18446744073709551615");
        assert!(Certificate::from_text(&endless).is_err());
        let old = Certificate::from_text(&TEXT.replace("certificate 2", "certificate 1"));
        assert!(old.is_err_and(|e| e.to_string().contains("version 2")));
    }

    proptest! {
        #[test]
        fn a_damaged_head_is_read_or_refused(at in 0..TEXT.len(), with in "[a-z0-9 \n-]{0,4}") {
            let mut text = TEXT.to_owned();
            text.replace_range(at..=at, &with);
            let _ = Certificate::from_text(&text);
        }
    }
}
