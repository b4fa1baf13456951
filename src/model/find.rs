//! Models by the name of a file or of a built-in model.

use super::{Model, ModelError, PRESETS};
use std::path::Path;

impl Model {
    /// The model called `name`: a file (below `folder`, where one is given) or, where there is no such file, a built-in
    /// model. The flag says whether it is a file.
    ///
    /// # Errors
    /// [`ModelError::Neither`] where there is neither, [`ModelError::File`] where the file is refused.
    pub fn find(name: &str, folder: Option<&Path>) -> Result<(Self, bool), ModelError> {
        let path = folder.map_or_else(|| Path::new(name).to_owned(), |folder| folder.join(name));
        if path.is_file() {
            let refused = |source| ModelError::File { file: path.display().to_string(), source: Box::new(source) };
            return Ok((Self::read(&path).map_err(refused)?, true));
        }
        if PRESETS.iter().any(|(known, _)| *known == name) {
            return Ok((Self::preset(name)?, false));
        }
        Err(ModelError::Neither { name: name.to_owned() })
    }
}
