//! What relights, whatever the codec.

use super::BakeError;
use etendue_core::backend::Session;
use etendue_core::radiosity::blocks::{self, BlockOperator};
use etendue_core::radiosity::relight::{Relighter, Workspace};

/// How light gets from patch to patch.
#[derive(Clone, Debug, PartialEq)]
pub enum Transport {
    /// Form factors in tiles.
    Tiles(Box<Relighter>),
    /// Texture blocks.
    Blocks(Box<BlockOperator>),
}

/// Room for relighting.
#[derive(Clone, Debug, Default)]
pub struct Rooms {
    tiles: Workspace,
    blocks: blocks::Workspace,
}

impl Transport {
    /// Bytes of everything a relighting reads.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Tiles(t) => t.bytes(),
            Self::Blocks(b) => b.bytes(),
        }
    }

    /// Indirect irradiance \[W/m^2\] from direct irradiance and emission. Of the published codec, which gives radiosity, black patches get none.
    ///
    /// # Errors
    /// Of numbers that do not fit.
    pub fn relight(
        &self,
        session: &dyn Session,
        light: (&[[f32; 3]], &[[f32; 3]]),
        indirect: &mut [[f32; 3]],
        passes: u32,
        rooms: &mut Rooms,
    ) -> Result<(), BakeError> {
        match self {
            Self::Tiles(t) => session.relight(t, light, indirect, passes, &mut rooms.tiles)?,
            Self::Blocks(b) => {
                session.relight_blocks(b, light, indirect, &mut rooms.blocks)?;
                b.to_irradiance(indirect);
            }
        }
        Ok(())
    }
}
