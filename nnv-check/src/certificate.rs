//! A proof of a whole property as a text file.

use super::check::{CheckError, check};
use super::model::Network;
use super::proof::{Proof, ProofError};
use super::property::Property;
use std::path::{Path, PathBuf};

/// First line of the file.
const MAGIC: &str = "cede-certificate 1";

/// A proof that a network has a property: where both are, and the tree of each query.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Certificate {
    /// The network's file.
    pub onnx: PathBuf,
    /// The property's file.
    pub vnnlib: PathBuf,
    proofs: Vec<Proof>,
}

/// A certificate proves less than the property.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CertificateError {
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

impl Certificate {
    /// A certificate from the proofs of a prover.
    #[must_use]
    pub fn new(onnx: &Path, vnnlib: &Path, proofs: Vec<Proof>) -> Self {
        Self {
            onnx: onnx.to_owned(),
            vnnlib: vnnlib.to_owned(),
            proofs,
        }
    }

    /// The certificate's text.
    #[must_use]
    pub fn to_text(&self) -> String {
        let head = format!(
            "{MAGIC}\nonnx {}\nvnnlib {}\nqueries {}\n",
            self.onnx.display(),
            self.vnnlib.display(),
            self.proofs.len()
        );
        self.proofs
            .iter()
            .fold(head, |text, proof| text + &proof.to_text())
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
        head(1, MAGIC, "not a certificate of Cede (version 1)")?;
        let onnx = head(2, "onnx ", "expected: onnx FILE")?.into();
        let vnnlib = head(3, "vnnlib ", "expected: vnnlib FILE")?.into();
        let count = head(4, "queries ", "expected: queries NUMBER")?.parse::<usize>();
        let count = count.map_err(|_| ProofError {
            line: 4,
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
                onnx,
                vnnlib,
                proofs,
            }),
        }
    }

    /// Checks that the network has the property; gives the number of regions.
    ///
    /// # Errors
    /// The first thing that does not convince.
    pub fn check(&self, network: &Network, property: &Property) -> Result<usize, CertificateError> {
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

    const TEXT: &str = "cede-certificate 1\nonnx a.onnx\nvnnlib b.vnnlib\nqueries 0\n";

    #[test]
    fn a_head_is_read() {
        let read = Certificate::from_text(TEXT).expect("well formed");
        assert_eq!(
            read,
            Certificate::new(Path::new("a.onnx"), Path::new("b.vnnlib"), vec![])
        );
        let endless = TEXT.replace("queries 0", "queries 18446744073709551615");
        assert!(Certificate::from_text(&endless).is_err());
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
